// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::cli {

/// Runs the `orchard` tool: parses the command line, runs the subcommand, and prints every error as
/// one clear sentence. Returns the exit code (bus::ExitCode).
int run_command_line(int argc, char** argv);

}  // namespace orchard::cli
