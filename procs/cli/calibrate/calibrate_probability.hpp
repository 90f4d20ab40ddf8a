// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

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
int run_calibrate_probability(const CalibrateProbabilityOptions& options);

}  // namespace orchard::cli
