// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::cli {

/// The `orchard` tool: parses the command line, runs the subcommand, prints every error as one
/// clear sentence, and returns the exit code (bus::ExitCode).
int run_command_line(int argc, char** argv);

}  // namespace orchard::cli
