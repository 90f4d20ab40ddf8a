// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard calibrate appearance LOG... --observations CSV... --config IN --out OUT`.
struct CalibrateAppearanceOptions {
  std::vector<std::string> log_paths;          ///< drives with scans and pictures
  std::vector<std::string> observation_paths;  ///< truth of each log's scans, in the same order
  std::string config_path;
  std::string out_path;  ///< empty or config_path: that file; the old one is kept as .bak
  int stride = 5;        ///< uses every stride-th scan: consecutive scans are similar
  bool quiet = false;
};

/// Learns the appearance of trunks from drives with ground truth and writes the model into a rig's
/// YAML; returns the exit code. Throws io::FileError and io::ConfigError, and then writes nothing.
int run_calibrate_appearance(const CalibrateAppearanceOptions& options);

}  // namespace orchard::cli
