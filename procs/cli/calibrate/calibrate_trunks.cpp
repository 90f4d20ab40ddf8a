// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate/calibrate_trunks.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <utility>

#include "bus/process/process.hpp"
#include "bus/replay/in_process_replay.hpp"
#include "calibration/trunks/trunk_appearance.hpp"
#include "calibration/trunks/trunk_model.hpp"
#include "calibration/trunks/trunk_selection.hpp"
#include "cli/calibrate/appearance_values.hpp"
#include "cli/calibrate/calibrate_pictures.hpp"
#include "cli/calibrate/number_list.hpp"
#include "cli/calibrate/picked_ids.hpp"
#include "cli/calibrate/trunk_collector.hpp"
#include "cli/calibrate/trunk_list.hpp"
#include "io/config/config.hpp"
#include "io/config/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/map/map_csv.hpp"
#include "io/progress_bar.hpp"
#include "pose/pose_node.hpp"
#include "text/number_text.hpp"

namespace orchard::cli {
namespace {

TrunkDrives observe_logs(const CalibrateTrunksOptions& options, const io::Config& config) {
  TrunkDrives drives;
  drives.log_paths = options.log_paths;
  int num_pairs = 0;
  for (std::size_t i = 0; i < options.log_paths.size(); ++i) {
    procs::PoseNode pose(config);
    TrunkCollector collector(config, static_cast<int>(i), !options.list_folder.empty());
    io::ProgressBar bar("reading logs", !options.quiet);
    bus::ReplayOptions replay;
    replay.progress = [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
    const bus::ReplayReport report =
        bus::replay_in_process(options.log_paths[i], {&pose, &collector}, replay);
    bar.finish();
    for (const std::string& warning : report.warnings) {
      std::fprintf(stderr, "orchard calibrate: warning: %s\n", warning.c_str());
    }
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
  namespace fs = std::filesystem;
  const std::string path = fs::is_directory(options.map_folder)
                               ? (fs::path(options.map_folder) / "map.csv").string()
                               : options.map_folder;
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
  rules.wanted_trunks = options.wanted_trunks;
  rules.gate_m = config.mapper.gate_m;
  if (!options.trees.empty()) rules.picked = parse_number_list(options.trees, "--trees");
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
  if (!options.pictures.picture_folder.empty()) {
    CalibratePicturesOptions pictures{options.pictures, options.config_path, options.out_path};
    pictures.pictures.quiet = options.quiet;
    return run_calibrate_pictures(pictures);
  }
  const io::Config config = io::load_config(options.config_path);
  if (options.log_paths.empty())
    throw io::FileError("no input: give the logs of drives past trunks");
  const calibration::TrunkModelOptions rules = rules_of(options, config);
  const TrunkDrives drives = observe_logs(options, config);
  const auto& observations = drives.observations;
  calibration::TrunkModel model;
  try {
    model = calibration::estimate_trunk_model(observations, rules);
    if (options.colour_model != ColourChoice::kHueInterval) {
      model = calibration::select_trunks(observations, model, rules);
    }
  } catch (const std::runtime_error& error) {
    throw io::FileError(options.log_paths.front() + ": " + error.what());
  }
  if (!options.list_folder.empty()) {
    write_trunk_list(options.list_folder, model, observations);
    std::printf(
        "%zu objects written to %s/index.html and things.csv; the configuration was not changed\n",
        model.objects.size(), options.list_folder.c_str());
    return bus::kExitOk;
  }
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
                     std::filesystem::path(options.log_paths.front()).filename().string();
  if (options.log_paths.size() > 1) {
    note += " and " + std::to_string(options.log_paths.size() - 1) + " more";
  }
  if (!options.trees.empty()) note += ", picked by number";
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
  const std::string out = options.out_path.empty() ? options.config_path : options.out_path;
  io::edit_config_file(options.config_path, out, values, "orchard calibrate trunks", note);
  if (!options.quiet) std::printf("written to %s\n", out.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
