// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command_line.hpp"
#include "cli/commands.hpp"

int main(int argc, char** argv) {
  return orchard::cli::run_command_line(argc, argv, orchard::cli::add_all_commands);
}
