// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace orchard::cli {

/// Sets up the texts of the help. Call it before the commands are added; they inherit the settings.
void set_up_help(CLI::App& app);

/// Adds --version to every command and completes examples with the paths of the rigs of config/.
/// Call it after all commands have been added.
void finish_help(CLI::App& app);

/// The folder of the rigs that come with the program: the installed one, else config/ of the
/// checkout.
std::string config_folder();

}  // namespace orchard::cli
