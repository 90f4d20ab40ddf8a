// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/board/board.hpp"

namespace orchard::cli {

/// `orchard calibrate camera PICTURES...|LOG --columns N --rows N --square-m M --out RIG`, or
/// `orchard calibrate camera --import FILE --out RIG`.
struct CalibrateCameraOptions {
  std::vector<std::string> paths;  ///< pictures, folders of them, or one log
  std::string import_path;         ///< result of another tool to import instead
  std::string board_kind = "chessboard";
  calibration::BoardConfig board;
  std::string config_path;    ///< rig to start from
  std::string out_path;       ///< rig to write; empty: config_path; both empty: print only
  std::string coverage_path;  ///< also draws the positions of the corners
  int max_views = 40;         ///< selects the most different ones
  bool estimate_k3 = false;
  bool force = false;  ///< writes the result even if it fails the checks
  bool quiet = false;
};

/// Calibrates (or imports) a camera's intrinsics, checks them, and writes them into a rig's YAML,
/// keeping its comments and layout. Returns the exit code: 3, with the reasons printed, when the
/// result should not be used. Throws io::FileError and io::ConfigError, and then writes nothing.
int run_calibrate_camera(const CalibrateCameraOptions& options);

}  // namespace orchard::cli
