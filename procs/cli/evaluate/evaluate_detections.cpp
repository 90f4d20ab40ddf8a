// SPDX-License-Identifier: BSD-3-Clause
#include "cli/evaluate/evaluate_detections.hpp"

#include <cstdio>
#include <filesystem>
#include <utility>

#include "bus/process/process.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "evaluation/detections/detection_report.hpp"
#include "io/file_error.hpp"
#include "io/map/map_folder.hpp"
#include "io/recording/observation_csv.hpp"
#include "io/recording/truth_csv.hpp"

namespace orchard::cli {
namespace {

namespace fs = std::filesystem;
using evaluation::ObservationPair;

/// Observations of all recordings, and the landmarks of those with a truth.
struct Material {
  std::vector<ObservationPair> observations;
  std::vector<std::string> names;
  int num_scans = 0;
  bool has_landmarks = false;
  evaluation::LandmarkEvaluation landmarks;
  std::vector<evaluation::Forecast> forecasts;
};

void check_counts(const EvaluateDetectionsOptions& options) {
  if (options.observation_paths.size() != options.paths.size()) {
    throw io::FileError("there are " + std::to_string(options.paths.size()) + " recordings and " +
                        std::to_string(options.observation_paths.size()) +
                        " observation files; give one --observations per recording, in order");
  }
  if (!options.truth_paths.empty() && options.truth_paths.size() != options.paths.size()) {
    throw io::FileError("there are " + std::to_string(options.paths.size()) + " recordings and " +
                        std::to_string(options.truth_paths.size()) +
                        " truth files; give one --truth per recording, in order, or none");
  }
}

void add_landmarks(const EvaluateDetectionsOptions& options, std::size_t i,
                   const std::vector<ObservationPair>& observations, Material& material) {
  const std::string& path = options.paths[i];
  if (!fs::is_directory(path)) {
    throw io::FileError(path +
                        " is not a map folder; with --truth give map folders, to evaluate the "
                        "landmarks of map.csv");
  }
  const auto truth = io::read_truth_csv(options.truth_paths[i]);
  const auto landmarks = io::read_map_csv((fs::path(path) / "map.csv").string());
  const auto result = evaluation::evaluate_landmarks(
      landmarks, truth, evaluation::was_observed(observations, truth.size(), options.rules),
      options.rules.gate_m, &material.forecasts);
  material.has_landmarks = true;
  material.landmarks.counts += result.counts;
  material.landmarks.num_trees += result.num_trees;
  if (options.paths.size() == 1) material.landmarks.trees = result.trees;
}

void add_recording(const EvaluateDetectionsOptions& options, std::size_t i, Material& material) {
  const auto messages = read_detections(options.paths[i]);
  const auto truth = io::read_observation_csv(options.observation_paths[i]);
  evaluation::ObservationPairs found =
      evaluation::pair_observations(messages, truth, static_cast<int>(i), {options.rules.gate_m});
  if (found.num_scans == 0) {
    throw io::FileError(options.observation_paths[i] + " has no scan in common with " +
                        options.paths[i] +
                        ": no time stamp is equal; give the CSV that `orchard simulate "
                        "--observations` wrote with that log");
  }
  if (found.num_without_truth > 0) {
    std::fprintf(
        stderr, "orchard evaluate: warning: %s: %d scans with detections are missing in %s\n",
        options.paths[i].c_str(), found.num_without_truth, options.observation_paths[i].c_str());
  }
  if (!options.truth_paths.empty()) add_landmarks(options, i, found.pairs, material);
  material.names.push_back(fs::path(options.paths[i]).filename().string());
  material.num_scans += found.num_scans;
  material.observations.insert(material.observations.end(),
                               std::make_move_iterator(found.pairs.begin()),
                               std::make_move_iterator(found.pairs.end()));
}

}  // namespace

int run_evaluate_detections(const EvaluateDetectionsOptions& given) {
  EvaluateDetectionsOptions options = given;
  options.rules.in_picture = !options.without_picture;
  check_counts(options);
  Material material;
  for (std::size_t i = 0; i < options.paths.size(); ++i) add_recording(options, i, material);
  evaluation::DetectionEvaluation result =
      evaluation::evaluate_detections(material.observations, material.names, options.rules);
  result.num_scans = material.num_scans;
  if (material.has_landmarks) {
    material.landmarks.reliability = evaluation::reliability(material.forecasts);
    result.landmarks = material.landmarks;
  }
  if (options.json) {
    std::fputs(detection_json(result).c_str(), stdout);
  } else {
    std::fputs(detection_tables(result).c_str(), stdout);
  }
  return bus::kExitOk;
}

}  // namespace orchard::cli
