// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "cli/add_command.hpp"
#include "cli/calibrate/calibrate.hpp"

namespace orchard::cli {
namespace {

void add_board_options(CLI::App& command, calibration::BoardConfig& board) {
  add_shown(command, "--columns", board.columns);
  add_shown(command, "--rows", board.rows);
  add_shown(command, "--square-m", board.square_m);
}

void declare(CLI::App& command, CalibrateCameraOptions& o) {
  add_value(command, "pictures", o.paths, "PICTURES...|LOG");
  add_value(command, "--import", o.import_path, "FILE");
  add_board_options(command, o.board);
  add_value(command, "--config", o.config_path, "FILE");
  add_value(command, "--out", o.out_path, "FILE");
  command.add_flag("--k3", o.estimate_k3);
  command.add_flag("--force", o.force);
  command.add_flag("--quiet", o.quiet);
}

void declare(CLI::App& command, CalibrateLaserCameraOptions& o) {
  add_required(command, "log", o.log_path, "LOG");
  add_required(command, "--config", o.config_path, "FILE");
  add_value(command, "--out", o.out_path, "FILE");
  add_board_options(command, o.board);
  CLI::Option* width =
      add_value(command, "--board-width-m", o.board_width_m, "M")->check(CLI::PositiveNumber);
  CLI::Option* height =
      add_value(command, "--board-height-m", o.board_height_m, "M")->check(CLI::PositiveNumber);
  width->needs(height);
  height->needs(width);
  command.add_flag("--any-mount", o.any_mount);
  command.add_flag("--quiet", o.quiet);
}

void declare(CLI::App& command, CalibrateDelayOptions& o) {
  add_required(command, "logs", o.log_paths, "LOG...");
  add_required(command, "--config", o.config_path, "FILE");
  add_value(command, "--out", o.out_path, "FILE");
  command.add_flag("--laser", o.of_laser);
  command.add_flag("--quiet", o.quiet);
}

void declare(CLI::App& command, CalibrateTrunksOptions& o) {
  add_required(command, "logs", o.log_paths, "LOG...");
  add_required(command, "--config", o.config_path, "FILE");
  add_value(command, "--out", o.out_path, "FILE");
  const std::map<std::string, ColourChoice> choices{{"auto", ColourChoice::kAuto},
                                                    {"hue_interval", ColourChoice::kHueInterval},
                                                    {"appearance", ColourChoice::kAppearance}};
  add_value(command, "--colour-model", o.colour_model, "MODEL")
      ->transform(CLI::CheckedTransformer(choices));
  const std::map<std::string, DecisionChoice> decisions{
      {"auto", DecisionChoice::kAuto},
      {"roc", DecisionChoice::kRoc},
      {"probability", DecisionChoice::kProbability}};
  add_value(command, "--decision", o.decision, "DECISION")
      ->transform(CLI::CheckedTransformer(decisions));
  CLI::Option* map = add_value(command, "--map", o.map_folder, "DIR");
  CLI::Option* ids = command.add_option("--ids", o.ids);
  ids->needs(map);
  map->needs(ids);
  command.add_flag("--quiet", o.quiet);
}

}  // namespace

void add_calibrate(CLI::App& app, Run& run) {
  CLI::App& calibrate = add_group(app, "calibrate");
  add_command(calibrate, run, "camera", run_calibrate_camera, declare);
  add_command(calibrate, run, "trunks", run_calibrate_trunks, declare);
  add_command(calibrate, run, "laser-camera", run_calibrate_laser_camera, declare);
  add_command(calibrate, run, "delay", run_calibrate_delay, declare);
}

}  // namespace orchard::cli
