// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/add_command.hpp"

namespace orchard::cli {

/// Adds all commands of `orchard`, in the order of its help.
void add_all_commands(CLI::App& app, Run& run);

}  // namespace orchard::cli
