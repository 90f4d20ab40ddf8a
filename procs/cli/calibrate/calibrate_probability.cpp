// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "calibration/trunks/landmark_outcomes.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "detection/detection.hpp"
#include "io/config/config.hpp"
#include "io/file_error.hpp"
#include "io/map/corrected_map.hpp"

namespace orchard::cli {
namespace {

/// A log, and the folder of its map.
struct MappedLog {
  std::string log_path;
  std::string map_folder;
  std::string ids;    ///< landmarks that are trees, all others being objects; empty: their classes
  int recording = 0;  ///< of the samples
};

using calibration::LandmarkSamples;
using detection::Label;
using mapping::CorrectionOutcome;
using mapping::Landmark;

/// Whether a person's correction of what stands there, or of its class, applies to the map.
bool is_checked(const io::CorrectedMapFolder& map) {
  using mapping::CorrectionKind;
  for (std::size_t i = 0; i < map.corrections.size(); ++i) {
    const CorrectionOutcome outcome = map.corrected.results[i].outcome;
    if (outcome == CorrectionOutcome::kUndone || outcome == CorrectionOutcome::kConflict) continue;
    const CorrectionKind kind = map.corrections[i].kind;
    if (kind == CorrectionKind::kClass || kind == CorrectionKind::kDelete ||
        kind == CorrectionKind::kAdd || kind == CorrectionKind::kMerge ||
        kind == CorrectionKind::kSplit) {
      return true;
    }
  }
  return false;
}

/// The landmarks with the classes to learn from.
std::vector<Landmark> judged_landmarks(const io::CorrectedMapFolder& map, const MappedLog& mapped) {
  std::vector<Landmark> landmarks = map.corrected.landmarks;
  if (mapped.ids.empty()) {
    if (!is_checked(map)) {
      std::fprintf(stderr,
                   "orchard calibrate: warning: nobody has corrected %s: the classes learnt from "
                   "are the map's own, which nobody checked; correct them with `orchard edit`, or "
                   "name the trees with --ids\n",
                   mapped.map_folder.c_str());
    }
    return landmarks;
  }
  const std::vector<int> ids = picked_ids(mapped.ids, landmarks, map.mapped.name);
  for (Landmark& landmark : landmarks) {
    const bool is_tree = std::binary_search(ids.begin(), ids.end(), landmark.id);
    landmark.label = is_tree ? Label::kTree : Label::kObject;
  }
  return landmarks;
}

const std::vector<pose::PoseEstimate>& path_of(const io::CorrectedMapFolder& map,
                                               const MappedLog& mapped) {
  const auto& paths = map.mapped.trajectories;
  if (paths.empty()) {
    throw io::FileError(mapped.map_folder +
                        " has no trajectory.csv, so the detections have no place in it; give the "
                        "folder that `orchard map` wrote for " +
                        mapped.log_path);
  }
  if (paths.size() > 1) {
    throw io::FileError(mapped.map_folder + " is of " + std::to_string(paths.size()) +
                        " drives; give the map of " + mapped.log_path + " alone");
  }
  return paths.front();
}

/// Rejects the map of another log or in another frame. That of this log was made from detections at
/// its landmarks, so about as many must fit there again; half, because the rig may have changed.
void require_same_log(const LandmarkSamples& found, const std::vector<Landmark>& landmarks,
                      const MappedLog& mapped) {
  if (found.num_placed_scans == 0) {
    throw io::FileError(mapped.map_folder + " has no pose at the time of any scan of " +
                        mapped.log_path + "; give the map of this log");
  }
  std::int64_t num_mapped = 0;
  for (const Landmark& landmark : landmarks) num_mapped += landmark.num_observations;
  if (2 * std::int64_t{found.num_fitting} < num_mapped) {
    throw io::FileError(
        fmt::format("only {} detections of {} are at a landmark of {}, whose landmarks have {} "
                    "observations; give the map of this log, in its own frame",
                    found.num_fitting, mapped.log_path, mapped.map_folder, num_mapped));
  }
  const std::size_t num_detections =
      found.samples.size() + static_cast<std::size_t>(found.num_doubtful);
  if (2 * static_cast<std::size_t>(found.num_fitting) >= num_detections) return;
  std::fprintf(stderr,
               "orchard calibrate: warning: only %d of %zu detections of %s fit a landmark of %s: "
               "much there moves or sways, or it is the map of another log\n",
               found.num_fitting, num_detections, mapped.log_path.c_str(),
               mapped.map_folder.c_str());
}

void require_both_classes(const LandmarkSamples& found, const MappedLog& mapped) {
  if (found.num_trees > 0 && found.num_objects > 0) return;
  throw io::FileError(fmt::format(
      "of the landmarks of {} that are observed in {}, {} are trees and {} objects, but both are "
      "needed; name the trees with --ids, or correct the classes with `orchard edit`",
      mapped.map_folder, mapped.log_path, found.num_trees, found.num_objects));
}

/// Labels the detections of a log by the landmarks of its map, with the corrections saved beside
/// it, and prints how many unless `quiet`. Without ids, warns if nobody has corrected the map.
/// Throws io::FileError for ids that the map has not, a map without path or without trees or
/// objects, and one of another log.
std::vector<calibration::ProbabilitySample> map_samples(
    const MappedLog& mapped, const std::vector<detection::Detections>& messages,
    const io::Config& config, bool quiet) {
  const io::CorrectedMapFolder map = io::read_corrected_map(mapped.map_folder);
  const auto& path = path_of(map, mapped);
  const calibration::LandmarkOutcomes outcomes(judged_landmarks(map, mapped), config.mapper);
  LandmarkSamples found =
      calibration::landmark_samples(messages, path, outcomes, config.mapper, mapped.recording);
  require_same_log(found, outcomes.landmarks(), mapped);
  require_both_classes(found, mapped);
  if (!quiet) {
    std::printf(
        "%s: %d detections of %d trees and %d objects, %zu of neither, %d left out that may be of "
        "either\n",
        mapped.map_folder.c_str(), found.num_matched, found.num_trees, found.num_objects,
        found.samples.size() - static_cast<std::size_t>(found.num_matched), found.num_doubtful);
  }
  return std::move(found.samples);
}

}  // namespace

int run_calibrate_probability(const CalibrateProbabilityOptions& options) {
  const io::Config config = io::load_config(options.config_path);
  const std::size_t num = options.map_folders.size();
  if (num != options.log_paths.size()) {
    throw io::FileError("there are " + std::to_string(options.log_paths.size()) + " logs and " +
                        std::to_string(num) + " maps; give one --map per log, in order");
  }
  std::vector<calibration::ProbabilitySample> samples;
  for (std::size_t i = 0; i < num; ++i) {
    const auto messages = detect_log(options.log_paths[i], config, !options.quiet);
    const auto more = map_samples(
        {options.log_paths[i], options.map_folders[i], options.ids, static_cast<int>(i)}, messages,
        config, options.quiet);
    samples.insert(samples.end(), more.begin(), more.end());
  }
  return write_probability(options, config, samples);
}

}  // namespace orchard::cli
