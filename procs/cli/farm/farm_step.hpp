// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// Options of `orchard farm step NAME [-- COMMAND...]`, which the Snakefile calls in the farm's
/// folder.
struct FarmStepOptions {
  std::string name;                  ///< name of the result: results/NAME
  std::vector<std::string> command;  ///< "@out" in it stands for the output folder
  std::string set_aside;             ///< without a command: the reason why there is no result
  bool keep_output = false;          ///< the output is the result; exit code 3 counts as good
};

/// Runs a command that computes a result in a temporary folder, and renames the folder when the
/// command has ended. A result is therefore complete or missing, even after a kill. Exit code 3
/// (bad input) sets the result aside with the command's message; so does a crash, because it
/// depends on the input and would recur. Any other failure gives no result and exit code 1. Throws
/// io::FileError.
int run_farm_step(const FarmStepOptions& options);

}  // namespace orchard::cli
