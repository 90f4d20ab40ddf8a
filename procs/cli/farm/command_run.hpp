// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace orchard::cli {

/// How a command ended, and what it cost.
struct CommandEnd {
  int exit_code = 0;  ///< 128 + signal of one that was killed; 127: it cannot be run
  double wall_s = 0.0;
  double processor_s = 0.0;
  double memory_mb = 0.0;  ///< peak of its largest process
};

/// Runs a program of the search path and waits for its end. What it prints is written to
/// `output_path` (empty: as this process prints), and `stdout_path`, when given, takes standard
/// output. `in_folder`: empty: this one. `while_running`, when given, is called twice a second.
/// Throws std::system_error when no process can be made.
CommandEnd run_command(const std::vector<std::string>& arguments, const std::string& output_path,
                       const std::string& stdout_path = {}, const std::string& in_folder = {},
                       const std::function<void()>& while_running = {});

}  // namespace orchard::cli
