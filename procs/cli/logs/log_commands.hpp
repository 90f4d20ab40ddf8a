// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard log info|check|config|repair LOG`.
struct LogOptions {
  std::string log_path;
  std::vector<std::string> log_paths;  ///< for info, instead: one log, or its parts
  std::string out_path;                ///< for repair
  bool json = false;                   ///< for info and check
  std::string process;  ///< for config: the rig of this process; empty: the common one
};

/// Prints the content of a log: channels, counts, rates, times. Returns the exit code.
int run_log_info(const LogOptions& options);

/// Prints all faults of a log; returns exit code 3 when there are any.
int run_log_check(const LogOptions& options);

/// Prints the rig stored in a log (CONFIG) as YAML for --config.
int run_log_config(const LogOptions& options);

/// Writes a new log with all readable messages. Refuses to overwrite the old one.
int run_log_repair(const LogOptions& options);

}  // namespace orchard::cli
