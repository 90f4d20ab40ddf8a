// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "calibration/board/board.hpp"
#include "cli/evaluate/mask_windows_reader.hpp"

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
[[gnu::weak]] int run_calibrate_laser_camera(const CalibrateLaserCameraOptions& options);

/// `orchard calibrate probability LOG... --map DIR... --config IN --out OUT`.
struct CalibrateProbabilityOptions {
  std::vector<std::string> log_paths;    ///< logs with scans, or derived logs
  std::vector<std::string> map_folders;  ///< the map of each log
  std::string ids;  ///< of the landmarks of a single map that are trees; empty: its classes
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  bool quiet = false;
};

/// Learns the probability of a tree as a function of the detector's measurements and writes it,
/// with the mapper's prior and correlation, into a rig's YAML; returns the exit code. Throws
/// io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_calibrate_probability(const CalibrateProbabilityOptions& options);

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

/// `orchard calibrate trunks LOG... --config IN --out OUT`, or with --images (calibrate_pictures).
struct CalibrateTrunksOptions {
  std::vector<std::string> log_paths;  ///< one or more drives past trunks of one kind
  std::string config_path;
  std::string out_path;    ///< empty or config_path: that file; the old one is kept as .bak
  int wanted_trunks = 20;  ///< min number without a warning
  ColourChoice colour_model = ColourChoice::kAuto;
  DecisionChoice decision = DecisionChoice::kAuto;
  std::string list_folder;        ///< only writes a page of all objects, for selecting trunks
  std::string trees;              ///< numbers of that page: "3,7,9-20"; empty: automatic
  std::string map_folder;         ///< or a first map (a folder, or its map.csv) and ...
  std::string ids;                ///< ... the ids of its trunks
  MaskedPictureOptions pictures;  ///< used instead of logs when it has folders
  bool quiet = false;
};

/// Measures the width (by range) and colour of the trunks in logs (the paper's initialisation), of
/// either the selected trunks or the largest homogeneous population, and how much either says of an
/// object. Writes them into a rig's YAML, keeping its comments and layout; returns the exit code.
/// Throws io::FileError and io::ConfigError, and then writes nothing.
[[gnu::weak]] int run_calibrate_trunks(const CalibrateTrunksOptions& options);

/// The same from pictures with masks: learns the appearance of trunks, with the hue interval of the
/// same windows for comparison.
int run_calibrate_pictures(const CalibrateTrunksOptions& options);

}  // namespace orchard::cli
