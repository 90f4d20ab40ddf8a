// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/calibrate/trunk_decision.hpp"
#include "cli/evaluate/mask_windows_reader.hpp"

namespace orchard::cli {

/// The colour model written by a calibration.
enum class ColourChoice {
  kAuto,         ///< the better one by the area under the ROC curve
  kHueInterval,  ///< the paper's
  kAppearance,
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
int run_calibrate_trunks(const CalibrateTrunksOptions& options);

}  // namespace orchard::cli
