// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard log info|check|config|repair LOG`.
struct LogOptions {
  std::string log_path;
  std::vector<std::string> log_paths;  ///< of info, instead: one, or the pieces of one
  std::string out_path;                ///< of repair
  bool json = false;                   ///< of info and check
  std::string process;  ///< of config: that of this process; empty: the one that all ran with
};

/// Prints what a log holds: channels, counts, rates, times. Returns the exit code.
int run_log_info(const LogOptions& options);

/// Prints everything that is wrong with a log; exit code 3 when something is.
int run_log_check(const LogOptions& options);

/// Prints the rig that a log carries (CONFIG) as YAML that --config reads.
int run_log_config(const LogOptions& options);

/// Writes a new log of every message that can be read. Refuses to write over the old one.
int run_log_repair(const LogOptions& options);

}  // namespace orchard::cli
