// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard farm step NAME [-- COMMAND...]`, which the Snakefile calls in the farm's folder.
struct FarmStepOptions {
  std::string name;                  ///< of the result: results/NAME
  std::vector<std::string> command;  ///< "@out" in it stands for the folder that it writes
  std::string set_aside;             ///< no command: why there can be no result
  bool keep_output = false;          ///< what it prints is the result, whatever its exit code
};

/// Runs a command that makes a result, in a folder of its own that becomes the result when it has
/// ended: a result is whole or not there, whoever is killed. Exit code 3 (a bad input) sets the
/// result aside with what the command said; so does a crash, which is a function of the input as
/// everything else. Any other failure is no result, and the exit code. Throws io::FileError.
int run_farm_step(const FarmStepOptions& options);

}  // namespace orchard::cli
