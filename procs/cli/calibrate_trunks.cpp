// SPDX-License-Identifier: BSD-3-Clause
#include "cli/calibrate_trunks.hpp"

#include <cstdio>
#include <filesystem>

#include "bus/in_process_replay.hpp"
#include "bus/process.hpp"
#include "calibration/trunk_model.hpp"
#include "cli/calibrate_pictures.hpp"
#include "cli/trunk_collector.hpp"
#include "io/config.hpp"
#include "io/config_edit.hpp"
#include "io/file_error.hpp"
#include "io/progress_bar.hpp"
#include "pose/pose_node.hpp"

namespace orchard::cli {
namespace {

std::string decimals(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

std::vector<calibration::TrunkObservation> look_at_logs(const CalibrateTrunksOptions& options,
                                                        const io::Config& config) {
  std::vector<calibration::TrunkObservation> looks;
  int num_pairs = 0;
  for (std::size_t i = 0; i < options.log_paths.size(); ++i) {
    procs::PoseNode pose(config);
    TrunkCollector collector(config, static_cast<int>(i));
    io::ProgressBar bar("looking", !options.quiet);
    bus::ReplayOptions replay;
    replay.progress = [&](std::uint64_t done, std::uint64_t total) { bar.update(done, total); };
    const bus::ReplayReport report =
        bus::replay_in_process(options.log_paths[i], {&pose, &collector}, replay);
    bar.finish();
    for (const std::string& warning : report.warnings) {
      std::fprintf(stderr, "orchard calibrate: warning: %s\n", warning.c_str());
    }
    const auto seen = collector.observations();
    looks.insert(looks.end(), seen.begin(), seen.end());
    num_pairs += collector.num_pairs();
  }
  if (num_pairs == 0) {
    throw io::FileError(options.log_paths.front() +
                        (config.camera.enabled
                             ? " holds no scan with an image at its time; trunks are learnt from "
                               "both (camera.enabled: false for a rig without a camera)"
                             : " holds no usable scan"));
  }
  return looks;
}

void print_table(const calibration::TrunkModel& model) {
  std::printf("%-6s %5s %9s %8s  %s\n", "thing", "looks", "width mm", "hue deg", "taken for");
  int number = 0;
  for (const calibration::ThingSeen& thing : model.things) {
    ++number;
    if (thing.num_observations < 2) continue;
    std::printf("%-6d %5d %9.1f %8.1f  %s\n", number, thing.num_observations,
                1e3 * thing.median_width_m, thing.dominant_hue_deg,
                thing.is_trunk ? "a trunk" : "something else");
  }
  std::printf("%d trunks, %d looks: width %.2f mm, sd %.2f mm", model.num_trunks,
              model.num_observations, 1e3 * model.width_mean_m, 1e3 * model.width_sd_m);
  if (model.has_hue) std::printf(", hue %.1f to %.1f deg", model.hue_min_deg, model.hue_max_deg);
  std::printf("\n");
}

}  // namespace

int run_calibrate_trunks(const CalibrateTrunksOptions& options) {
  if (!options.pictures.picture_folder.empty()) {
    CalibratePicturesOptions pictures{options.pictures, options.config_path, options.out_path};
    pictures.pictures.quiet = options.quiet;
    return run_calibrate_pictures(pictures);
  }
  const io::Config config = io::load_config(options.config_path);
  if (options.log_paths.empty()) throw io::FileError("no log was given to learn trunks from");
  const auto looks = look_at_logs(options, config);

  calibration::TrunkModelOptions rules;
  rules.wanted_trunks = options.wanted_trunks;
  rules.gate_m = config.mapper.gate_m;
  rules.hue_bins = config.detector.colour.hue_bins;
  calibration::TrunkModel model;
  try {
    model = calibration::estimate_trunk_model(looks, rules);
  } catch (const std::runtime_error& error) {
    throw io::FileError(options.log_paths.front() + ": " + error.what());
  }
  if (!options.quiet) print_table(model);
  for (const std::string& warning : model.warnings) {
    std::fprintf(stderr, "orchard calibrate: warning: %s\n", warning.c_str());
  }

  std::string note = std::to_string(model.num_trunks) + " trunks, " +
                     std::to_string(model.num_observations) + " looks in " +
                     std::filesystem::path(options.log_paths.front()).filename().string();
  if (options.log_paths.size() > 1) {
    note += " and " + std::to_string(options.log_paths.size() - 1) + " more";
  }
  std::vector<io::ConfigValue> values{{"detector.width.mean_m", decimals(model.width_mean_m, 5)},
                                      {"detector.width.sd_m", decimals(model.width_sd_m, 5)}};
  const std::string out = options.out_path.empty() ? options.config_path : options.out_path;
  if (model.has_hue) {
    values.push_back({"detector.colour.hue_min_deg", decimals(model.hue_min_deg, 1)});
    values.push_back({"detector.colour.hue_max_deg", decimals(model.hue_max_deg, 1)});
  }
  io::edit_config_file(options.config_path, out, values, "orchard calibrate trunks", note);
  if (!options.quiet) std::printf("written to %s\n", out.c_str());
  return bus::kExitOk;
}

}  // namespace orchard::cli
