// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace orchard::cli {

/// Help in the words of the person who reads it: to be called before the commands are added, which
/// inherit it.
void set_up_help(CLI::App& app);

/// --version for every command, and examples that name the rigs of config/ where they lie: to be
/// called when all commands have been added.
void finish_help(CLI::App& app);

/// The folder with the rigs that come with the program: where it is installed, config/ of the
/// checkout else.
std::string config_folder();

}  // namespace orchard::cli
