// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace orchard::cli {

/// A program to run.
struct FarmCommand {
  std::vector<std::string> words;
  bool is_own = false;  ///< words of this program, which runs them without being started again
  std::string stdout_path, stderr_path;   ///< may be one file
  std::string folder{};                   ///< working folder; empty: the current one
  std::function<void()> while_running{};  ///< if given, called twice a second
};

/// Exit code and resource usage of a command.
struct CommandResult {
  int exit_code = 0;  ///< 128 + signal if it was killed; 127 if it cannot be run
  double wall_s = 0.0;
  double processor_s = 0.0;
  double memory_mb = 0.0;   ///< peak of its largest process
  bool is_stopped = false;  ///< by SIGINT or SIGTERM: no other program is to be run
};

/// Runs a program of the search path and waits for its end. SIGINT and SIGTERM stop the program and
/// all that it has started, and this process goes on after their end; SIGKILL of this process kills
/// the program. Throws std::system_error when no process can be created.
CommandResult run_command(const FarmCommand& command);

}  // namespace orchard::cli
