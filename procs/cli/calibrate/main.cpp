// SPDX-License-Identifier: BSD-3-Clause
#include "cli/command_line.hpp"

// What `orchard calibrate` runs. A program of its own: its solvers take a good part of a build, and
// who makes maps does without them.
int main(int argc, char** argv) {
  return orchard::cli::run_command_line(argc, argv, orchard::cli::add_calibrate);
}
