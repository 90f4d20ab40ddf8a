// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "cli/add_command.hpp"

namespace orchard::cli {

/// The `orchard` tool with the commands that `add_commands` declares: parses the command line, runs
/// the subcommand, prints every error as one clear sentence, and returns the exit code
/// (bus::ExitCode).
int run_command_line(int argc, char** argv,
                     const std::function<void(CLI::App&, Run&)>& add_commands);

}  // namespace orchard::cli
