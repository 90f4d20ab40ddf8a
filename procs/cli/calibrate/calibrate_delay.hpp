// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard calibrate delay LOG... --config IN --out OUT`.
struct CalibrateDelayOptions {
  std::vector<std::string> log_paths;  ///< drives with curves past trunks
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  bool quiet = false;
};

/// Measures the camera's fixed delay (camera.delay_s) from logs of a turning robot and writes it
/// into a rig's YAML; returns the exit code. Throws io::FileError and io::ConfigError, and then
/// writes nothing.
int run_calibrate_delay(const CalibrateDelayOptions& options);

}  // namespace orchard::cli
