// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "calibration/board/board.hpp"

namespace orchard::cli {

/// Views of a board that are used, the most different ones; more only cost.
inline constexpr std::size_t kMaxViews = 40;

/// `orchard calibrate camera PICTURES...|LOG --columns N --rows N --square-m M --out RIG`, or
/// `orchard calibrate camera --import FILE --out RIG`.
struct CalibrateCameraOptions {
  std::vector<std::string> paths;  ///< pictures, folders of them, or one log
  std::string import_path;         ///< result of another tool to import instead
  calibration::BoardConfig board;
  std::string config_path;  ///< rig to start from
  std::string out_path;     ///< rig to write; empty: config_path; both empty: print only
  bool estimate_k3 = false;
  bool force = false;  ///< writes the result even if it fails the checks
  bool quiet = false;
};

/// Calibrates (or imports) a camera's intrinsics, checks them, and writes them into a rig's YAML,
/// keeping its comments and layout. Returns the exit code: 3, with the reasons printed, when the
/// result should not be used. Throws io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_calibrate_camera(const CalibrateCameraOptions& options);

/// `orchard calibrate delay LOG... --config IN --out OUT`.
struct CalibrateDelayOptions {
  std::vector<std::string> log_paths;  ///< drives with curves past trunks
  std::string config_path;
  std::string out_path;   ///< empty or config_path: that file; the old one is kept as .bak
  bool of_laser = false;  ///< of the scanners, although there is a camera
  bool quiet = false;
};

/// Measures the camera's fixed delay (camera.delay_s), or without a camera the scanners'
/// (drivers.laser.delay_s), from logs of a turning robot and writes it into a rig's YAML; returns
/// the exit code. Throws io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_calibrate_delay(const CalibrateDelayOptions& options);

/// `orchard calibrate laser-camera LOG --config IN --columns N --rows N --square-m S --out OUT`.
struct CalibrateLaserCameraOptions {
  std::string log_path;
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  calibration::BoardConfig board;
  double board_width_m = 0.0;  ///< outer size, with the pattern in the middle; 0: unknown
  double board_height_m = 0.0;
  bool any_mount = false;  ///< accept extrinsics that contradict the rig's YAML
  bool quiet = false;
};

/// Calibrates the laser-camera extrinsics from a log of a board in view of both, and writes them
/// into a rig's YAML, keeping its comments and layout; returns the exit code. Throws io::FileError
/// and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_calibrate_laser_camera(const CalibrateLaserCameraOptions& options);

/// The colour model written by a calibration.
enum class ColourChoice {
  kAuto,         ///< the better one by the area under the ROC curve
  kHueInterval,  ///< the paper's
  kAppearance,
};

/// The decision written by `calibrate trunks`.
enum class DecisionChoice {
  kAuto,         ///< the one with fewer errors on objects left out of the fit
  kRoc,          ///< the paper's
  kProbability,  ///< weights of width and camera learnt from the drive
};

/// `orchard calibrate trunks LOG... --config IN --out OUT`.
struct CalibrateTrunksOptions {
  std::vector<std::string> log_paths;  ///< one or more drives past trunks of one kind
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  ColourChoice colour_model = ColourChoice::kAuto;
  DecisionChoice decision = DecisionChoice::kAuto;
  std::string map_folder;  ///< a first map (a folder, or its map.csv) and ...
  std::string ids;         ///< ... the ids of its trunks; empty: automatic
  bool quiet = false;
};

/// Measures the width (by range) and colour of the trunks in logs (the paper's initialisation), of
/// either the selected trunks or the largest homogeneous population, and how much either says of an
/// object. Writes them into a rig's YAML, keeping its comments and layout; returns the exit code.
/// Throws io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_calibrate_trunks(const CalibrateTrunksOptions& options);

}  // namespace orchard::cli
