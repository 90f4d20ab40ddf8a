// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "calibration/board/board.hpp"

namespace orchard::cli {

/// `orchard calibrate laser-camera LOG --config IN --columns N --rows N --square-m S --out OUT`, or
/// `--import FILE` instead of a log.
struct CalibrateLaserCameraOptions {
  std::string log_path;
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  calibration::BoardConfig board;
  std::string board_kind = "chessboard";
  double board_width_m = 0.0;  ///< outer size, with the pattern in the middle; 0: unknown
  double board_height_m = 0.0;
  int max_views = 40;
  bool any_mount = false;  ///< accept extrinsics that contradict the rig's YAML
  std::string import_path;
  std::string import_axes = "toolbox";
  std::string import_angles = "stated";
  bool quiet = false;
};

/// Calibrates the laser-camera extrinsics from a log of a board in view of both, or imports them,
/// and writes them into a rig's YAML, keeping its comments and layout; returns the exit code.
/// Throws io::FileError and io::ConfigError, and then writes nothing.
int run_calibrate_laser_camera(const CalibrateLaserCameraOptions& options);

}  // namespace orchard::cli
