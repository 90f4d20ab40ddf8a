// SPDX-License-Identifier: BSD-3-Clause
#include "cli/add_command.hpp"

#include <CLI/CLI.hpp>
#include <utility>

namespace orchard::cli {

CLI::App& add_subcommand(CLI::App& app, const char* name, const char* description,
                         const char* examples) {
  CLI::App* command = app.add_subcommand(name, description);
  command->footer(std::string("Examples:\n") + examples);
  return *command;
}

void on_command(CLI::App& command, std::function<void()> callback) {
  // CLI11 calls a command's callback after those of its subcommands.
  command.callback([&command, callback = std::move(callback)] {
    if (command.get_subcommands().empty()) callback();
  });
}

}  // namespace orchard::cli
