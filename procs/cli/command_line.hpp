// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "cli/add_command.hpp"

namespace orchard::cli {

/// Runs the `orchard` tool with the commands declared by `add_commands`: parses the command line,
/// runs the subcommand, and prints every error as one clear sentence. Returns the exit code
/// (bus::ExitCode).
int run_command_line(int argc, char** argv,
                     const std::function<void(CLI::App&, Run&)>& add_commands);

}  // namespace orchard::cli
