// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard log mcap LOG... --out FILE`.
struct LogMcapOptions {
  std::vector<std::string> log_paths;
  std::string map_path;     ///< map folder or map.csv of the log; empty: none
  std::string config_path;  ///< empty: the rig stored in the log
  std::string out_path;
};

/// Converts a log, and its map, to MCAP for Foxglove and Lichtblick; returns the exit code. Throws
/// io::FileError and io::ConfigError.
int run_log_mcap(const LogMcapOptions& options);

}  // namespace orchard::cli
