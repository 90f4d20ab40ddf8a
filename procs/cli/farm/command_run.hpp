// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace orchard::cli {

/// Exit code and resource usage of a command.
struct CommandResult {
  int exit_code = 0;  ///< 128 + signal if it was killed; 127 if it cannot be run
  double wall_s = 0.0;
  double processor_s = 0.0;
  double memory_mb = 0.0;  ///< peak of its largest process
};

/// Runs a program of the search path and waits for its end. Its output is written to `output_path`
/// (empty: to this process's output), standard output to `stdout_path` if given. `in_folder`:
/// working folder; empty: the current one. `while_running`, if given, is called twice a second.
/// Throws std::system_error when no process can be created.
CommandResult run_command(const std::vector<std::string>& arguments, const std::string& output_path,
                          const std::string& stdout_path = {}, const std::string& in_folder = {},
                          const std::function<void()>& while_running = {});

}  // namespace orchard::cli
