// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace orchard::bus {

/// Options of the command line that every process has.
struct CommonOptions {
  std::string lcm_url;  ///< empty: not given
  std::string log_level = "info";
  bool print_config = false;
  bool print_all = false;  ///< with print_config: the expert keys, too
};

/// Adds --lcm-url, --log-level, --print-config and --all.
void add_common_options(CLI::App& app, CommonOptions& options);

/// Sends log lines of at least this level to stderr, each with the program's name; stdout is
/// reserved for output that was requested.
void set_up_log(const std::string& program, const std::string& level);

/// Full name of a process: "pose" is "orchard-pose".
std::string full_process_name(const std::string& name);

}  // namespace orchard::bus
