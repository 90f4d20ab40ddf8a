// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bus/process/process.hpp"
#include "calibration/trunks/landmark_outcomes.hpp"
#include "calibration/trunks/probability_learner.hpp"
#include "calibration/trunks/trunk_model.hpp"
#include "calibration/trunks/trunk_observation.hpp"
#include "calibration/trunks/trunk_selection.hpp"
#include "cli/calibrate/calibration_run.hpp"
#include "cli/evaluate/detection_log.hpp"
#include "cli/pair_node.hpp"
#include "geometry/pose2.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/folder.hpp"
#include "io/map/map_csv.hpp"
#include "mapping/pose_track.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/pose_node.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

/// Min number of beams: the width of narrower objects is unreliable.
constexpr int kMinBeams = 4;

/// Collects all objects of a log's scan-image pairs for calibration.
class TrunkCollector : public PairNode {
 public:
  TrunkCollector(const io::Config& config, int log)
      : PairNode(inputs_of(config), {config.detector.pairing_tolerance_s,
                                     config.detector.image_wait_s, false, config.camera.delay_s}),
        rig_(config.laser, config.camera, config.detector),
        path_(config.mapper.pose_gap_max_s),
        log_(log) {}

  void handle(const bus::Message& input, const bus::Outbox& send) override {
    if (const auto* pose = std::get_if<pose::PoseEstimate>(&input)) path_.add(*pose);
    PairNode::handle(input, send);
  }

  /// All observations in order of time; in the map frame where poses around their time are known.
  std::vector<calibration::TrunkObservation> observations() const {
    std::vector<calibration::TrunkObservation> observations = in_base_;
    for (calibration::TrunkObservation& observation : observations) {
      const auto pose = path_.at(observation.utime);
      if (!pose) continue;
      const Eigen::Vector2d p_map = geometry::transform(
          geometry::Pose2{pose->x_m, pose->y_m, pose->yaw_rad}, {observation.x_m, observation.y_m});
      observation.x_m = p_map.x();
      observation.y_m = p_map.y();
      observation.in_map = true;
    }
    return observations;
  }
  /// All poses of the log, in order of time.
  std::vector<pose::PoseEstimate> poses() const { return path_.poses(); }
  int num_pairs() const { return num_pairs_; }

 private:
  static std::vector<bus::Channel> inputs_of(const io::Config& config) {
    std::vector<bus::Channel> channels{bus::Channel::kScan, bus::Channel::kPose};
    if (config.camera.enabled) channels.push_back(bus::Channel::kImage);
    return channels;
  }
  void observe(detection::ScanImagePair pair) override {
    if (pair.image || !rig_.has_camera) ++num_pairs_;
    for (auto& seen : calibration::observe_trunks(pair.scan, pair.image.get(), rig_, kMinBeams)) {
      seen.log = log_;
      in_base_.push_back(std::move(seen));
    }
  }

  detection::Rig rig_;
  mapping::PoseTrack path_;  ///< T_map_base
  int log_;
  int num_pairs_ = 0;
  std::vector<calibration::TrunkObservation> in_base_;
};

/// The drives of a trunk model: one log and one path each.
struct TrunkDrives {
  std::vector<std::string> log_paths;
  std::vector<std::vector<pose::PoseEstimate>> paths;  ///< T_map_base over time
  std::vector<calibration::TrunkObservation> observations;
};

std::vector<calibration::ProbabilitySample> samples_of(const TrunkDrives& drives,
                                                       const calibration::TrunkModel& model,
                                                       const io::Config& config, bool quiet) {
  std::vector<calibration::ProbabilitySample> samples;
  for (std::size_t i = 0; i < drives.log_paths.size(); ++i) {
    const int log = static_cast<int>(i);
    const calibration::LandmarkOutcomes outcomes(
        calibration::object_landmarks(model, drives.observations, log), config.mapper);
    const auto found =
        calibration::landmark_samples(detect_log(drives.log_paths[i], config, !quiet),
                                      drives.paths[i], outcomes, config.mapper, log);
    samples.insert(samples.end(), found.begin(), found.end());
  }
  return samples;
}

/// Learns how much width and camera say in these drives (detector.probability), from the detections
/// at the model's trunks and other objects by the rig `learnt`, which already has their width and
/// colour. The colour model has seen all of these objects; what is left out is left out of the
/// weights alone. Returns the weights and the decision chosen, and adds a sentence to `note`; none
/// if there are too few detections and `choice` is kAuto; with kRoc the decision alone. Throws
/// io::FileError if kProbability cannot be learnt.
std::vector<io::ConfigValue> learn_decision(const TrunkDrives& drives,
                                            const calibration::TrunkModel& model, io::Config learnt,
                                            DecisionChoice choice, bool quiet, std::string& note) {
  if (choice == DecisionChoice::kRoc) return {{"detector.decision", "roc"}};
  learnt.detector.decision = detection::Decision::kRoc;
  learnt.detector.probability = {};
  try {
    const auto samples = samples_of(drives, model, learnt, quiet);
    calibration::ProbabilityLearnOptions rules;
    rules.width_mean_m = learnt.detector.width.mean_m;
    const auto fit = calibration::learn_probability(samples, rules);
    const calibration::DecisionErrors errors = calibration::decision_errors(samples, fit);
    const std::string text = fmt::format(
        "wrong of {} detections: decision: roc {}, probability {} (left-out {})", errors.num,
        errors.roc, errors.probability, drives.log_paths.size() > 1 ? "drives" : "objects");
    if (!quiet) std::printf("%s\n", text.c_str());
    note += "; " + text;
    const bool by_probability =
        choice == DecisionChoice::kProbability || errors.probability < errors.roc;
    // The weights are written in any case: earlier ones belong to another width and colour.
    std::vector<io::ConfigValue> values = probability_values(fit);
    values.push_back({"detector.decision", by_probability ? "probability" : "roc"});
    return values;
  } catch (const std::runtime_error& error) {
    if (choice == DecisionChoice::kProbability) {
      throw io::FileError(drives.log_paths.front() + ": " + error.what());
    }
    if (!quiet) {
      std::printf("detector.decision is unchanged, no probabilities were learnt: %s\n",
                  error.what());
    }
    return {};
  }
}

TrunkDrives observe_logs(const CalibrateTrunksOptions& options, const io::Config& config) {
  TrunkDrives drives;
  drives.log_paths = options.log_paths;
  std::set<std::string> said;
  int num_pairs = 0;
  for (std::size_t i = 0; i < options.log_paths.size(); ++i) {
    procs::PoseNode pose(config);
    TrunkCollector collector(config, static_cast<int>(i));
    replay_log("orchard calibrate", options.log_paths[i], {&pose, &collector}, options.quiet, said);
    const auto seen = collector.observations();
    drives.observations.insert(drives.observations.end(), seen.begin(), seen.end());
    drives.paths.push_back(collector.poses());
    num_pairs += collector.num_pairs();
  }
  if (num_pairs == 0) {
    throw io::FileError(
        options.log_paths.front() +
        (config.camera.enabled
             ? " has no scan with a picture of the same time; trunks are learnt from such pairs "
               "(for a rig without a camera set camera.enabled: false)"
             : " has no valid scan"));
  }
  return drives;
}

void print_table(const calibration::TrunkModel& model) {
  std::printf("%-6s %5s %9s %8s  %s\n", "object", "seen", "width mm", "hue deg", "class");
  int number = 0;
  for (const calibration::ObservedObject& thing : model.objects) {
    ++number;
    if (thing.num_observations < 2) continue;
    std::printf("%-6d %5d %9.1f %8.1f  %s\n", number, thing.num_observations,
                1e3 * thing.median_width_m, thing.dominant_hue_deg, calibration::class_name(thing));
  }
  std::printf("%d trunks, %d observations: width %.2f mm, sd %.2f mm", model.num_trunks,
              model.num_observations, 1e3 * model.width_mean_m, 1e3 * model.width_sd_m);
  if (model.has_hue) std::printf(", hue %.1f to %.1f deg", model.hue_min_deg, model.hue_max_deg);
  std::printf("\n");
}

void print_width_by_range(const calibration::WidthByRange& width) {
  std::printf("%16s %6s %9s %7s\n", "range m", "seen", "width mm", "sd mm");
  for (const calibration::WidthBin& bin : width.bins) {
    std::printf("%7.2f - %6.2f %6d %9.2f %7.2f\n", bin.range_min_m, bin.range_max_m,
                bin.num_observations, 1e3 * bin.mean_m, 1e3 * bin.sd_m);
  }
  if (width.has_growth) {
    std::printf("sd^2 = (%.2f mm)^2 + (%.2f x range x beam step)^2\n", 1e3 * width.sd_m,
                width.sd_per_beam_step);
  } else {
    std::printf(
        "the ranges are too similar to estimate the growth of sd with range: sd_per_beam_step is "
        "unchanged\n");
  }
}

void print_spot(const std::optional<calibration::SpotDivergence>& spot, double spot_rad) {
  if (!spot) {
    std::printf(
        "too few trunks at different ranges to estimate the divergence of the beam: spot_rad is "
        "unchanged\n");
    return;
  }
  std::printf("widths grow by %.1f mm per metre of range, standard error %.1f: spot_rad %s\n",
              1e3 * spot->divergence_rad, 1e3 * spot->se_rad,
              spot->significant() ? fixed_text(spot_rad, 4).c_str() : "is unchanged");
}

/// The beam divergence that makes the measured widths independent of range; at least zero.
double spot_rad_of(const calibration::TrunkModel& model, const io::Config& config) {
  if (!model.spot || !model.spot->significant()) return config.laser.spot_rad;
  return std::clamp(config.laser.spot_rad + model.spot->divergence_rad, 0.0, 0.05);
}

/// Positions of the landmarks with these ids in a first map.
std::vector<calibration::PickedTrunk> places_of(const CalibrateTrunksOptions& options) {
  const std::string path = io::file_in(options.map_folder, "map.csv");
  const auto landmarks = io::read_map_csv(path);
  std::vector<calibration::PickedTrunk> places;
  for (const int id : picked_ids(options.ids, landmarks, path)) {
    const auto found = std::find_if(landmarks.begin(), landmarks.end(),
                                    [id](const auto& landmark) { return landmark.id == id; });
    places.push_back({id, found->x_m, found->y_m});
  }
  return places;
}

calibration::TrunkModelOptions rules_of(const CalibrateTrunksOptions& options,
                                        const io::Config& config) {
  calibration::TrunkModelOptions rules;
  rules.gate_m = config.mapper.gate_m;
  if (!options.ids.empty()) rules.picked_trunks = places_of(options);
  return rules;
}

/// Returns the appearance model if it is requested or better than the hue interval, and prints the
/// choice and its reason.
std::optional<vision::AppearanceConfig> choose_appearance(
    const std::vector<calibration::TrunkObservation>& observations,
    const calibration::TrunkModel& model, const io::Config& config,
    const CalibrateTrunksOptions& options, std::string& note) {
  if (!model.has_hue || options.colour_model == ColourChoice::kHueInterval) return std::nullopt;
  try {
    const auto learnt =
        calibration::learn_trunk_appearance(observations, model, config.detector.colour);
    const std::string text = fmt::format(
        "area under the ROC curve, {} windows on trunks, {} elsewhere: appearance {:.4f} "
        "(cross-validated over trunks), hue interval {:.4f}",
        learnt.fit.num_trunk, learnt.fit.num_other, learnt.fit.area, learnt.hue_interval_area);
    if (!options.quiet) std::printf("%s\n", text.c_str());
    note += "; " + text;
    const bool better = learnt.fit.area > learnt.hue_interval_area;
    if (better || options.colour_model == ColourChoice::kAppearance) return learnt.fit.config;
  } catch (const std::runtime_error& error) {
    if (options.colour_model == ColourChoice::kAppearance) {
      throw io::FileError(options.log_paths.front() + ": " + error.what());
    }
    std::fprintf(stderr, "orchard calibrate: warning: no appearance model was learnt: %s\n",
                 error.what());
  }
  return std::nullopt;
}

std::vector<io::ConfigValue> values_of(const calibration::TrunkModel& model) {
  const calibration::WidthByRange& width = model.width_by_range;
  std::vector<io::ConfigValue> values{{"detector.width.mean_m", fixed_text(model.width_mean_m, 5)},
                                      {"detector.width.sd_m", fixed_text(width.sd_m, 5)}};
  if (width.has_growth) {
    values.push_back(
        {"detector.width.sd_per_beam_step", fixed_text(std::min(width.sd_per_beam_step, 5.0), 3)});
  }
  if (model.has_hue) {
    values.push_back({"detector.colour.hue_min_deg", fixed_text(model.hue_min_deg, 1)});
    values.push_back({"detector.colour.hue_max_deg", fixed_text(model.hue_max_deg, 1)});
  }
  return values;
}

}  // namespace

int run_calibrate_trunks(const CalibrateTrunksOptions& options) {
  const io::Config config = io::load_config(options.config_path);
  if (options.log_paths.empty())
    throw io::FileError("no input: give the logs of drives past trunks");
  const calibration::TrunkModelOptions rules = rules_of(options, config);
  const TrunkDrives drives = observe_logs(options, config);
  const auto& observations = drives.observations;
  const calibration::TrunkModel model = naming(options.log_paths.front(), [&] {
    const auto by_width = calibration::estimate_trunk_model(observations, rules);
    return options.colour_model == ColourChoice::kHueInterval
               ? by_width
               : calibration::select_trunks(observations, by_width, rules);
  });
  if (!options.quiet) {
    print_table(model);
    print_width_by_range(model.width_by_range);
    print_spot(model.spot, spot_rad_of(model, config));
  }
  for (const std::string& warning : model.warnings) {
    std::fprintf(stderr, "orchard calibrate: warning: %s\n", warning.c_str());
  }

  std::string note = std::to_string(model.num_trunks) + " trunks, " +
                     std::to_string(model.num_observations) + " observations in " +
                     logs_text(options.log_paths);
  if (!options.ids.empty()) note += ", picked by id";
  std::vector<io::ConfigValue> values = values_of(model);
  if (model.spot && model.spot->significant()) {
    values.push_back({"laser.spot_rad", fixed_text(spot_rad_of(model, config), 4)});
  }
  if (model.has_hue) {
    if (const auto appearance = choose_appearance(observations, model, config, options, note)) {
      const auto more = appearance_values(*appearance);
      values.insert(values.end(), more.begin(), more.end());
    } else if (config.detector.colour_model != detection::ColourModel::kHueInterval) {
      values.push_back({"detector.colour_model", "hue_interval"});
    }
  }
  // Without a camera, the trunks were chosen by their width alone: nothing tells how much it says.
  if (model.has_hue || model.is_picked) {
    const io::Config learnt = io::edited_config(options.config_path, values);
    const auto more = learn_decision(drives, model, learnt, options.decision, options.quiet, note);
    values.insert(values.end(), more.begin(), more.end());
  }
  write_rig(options.config_path, options.out_path, values, "orchard calibrate trunks", note,
            options.quiet);
  return bus::kExitOk;
}

}  // namespace orchard::cli
