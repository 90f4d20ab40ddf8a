// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/mask_windows_reader.hpp"

namespace orchard::cli {

/// `orchard calibrate trunks LOG... --config IN --out OUT`, or with --images (calibrate_pictures).
struct CalibrateTrunksOptions {
  std::vector<std::string> log_paths;  ///< one or more drives past trunks of one kind
  std::string config_path;
  std::string out_path;           ///< empty or config_path: that file, the old one as .bak
  int wanted_trunks = 20;         ///< fewer give a warning
  MaskedPictureOptions pictures;  ///< instead of logs, when it names folders
  bool quiet = false;
};

/// Measures width and hue of the trunks in logs (the paper's initialisation) and writes them into
/// a rig's YAML, whose comments and layout stay; returns the exit code. Throws io::FileError and
/// io::ConfigError, and then writes nothing.
int run_calibrate_trunks(const CalibrateTrunksOptions& options);

}  // namespace orchard::cli
