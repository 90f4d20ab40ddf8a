// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// Options of `orchard farm init DIR`.
struct FarmInitOptions {
  std::string folder;
  bool renew = false;  ///< overwrite Snakefile and profiles with those of this version
};

/// Options of `orchard farm add DIR LOG...`.
struct FarmAddOptions {
  std::string folder;
  std::vector<std::string> log_paths;
  std::string block, date, robot;
};

/// Creates a farm's folder with its Snakefile and profiles; existing files are kept. Throws
/// io::FileError.
[[gnu::weak]] int run_farm_init(const FarmInitOptions& options);

/// Copies logs into the farm's folder; reports and skips logs that are already there. Throws
/// io::FileError, also if a different log has the same name.
[[gnu::weak]] int run_farm_add(const FarmAddOptions& options);

/// A file of config/farm, built into the program, that `farm init` writes.
struct ShippedFile {
  const char* name;
  const char* text;
};
extern const ShippedFile kFarmFiles[];
extern const int kNumFarmFiles;

/// Options of `orchard farm run DIR`.
struct FarmRunOptions {
  std::string folder;
  std::string profile = "local";  ///< folder in profiles/
  int cores = 0;                  ///< 0: all cores of this machine, or the profile's number
  bool keep_version = false;      ///< results of other programs or another Snakefile stay valid
};

/// Options of `orchard farm publish DIR`.
struct FarmPublishOptions {
  std::string folder;
};

/// Computes all missing results with Snakemake, then prints the status. Returns exit code 1 when a
/// step failed; the other steps are completed, and another run continues. Throws io::FileError.
[[gnu::weak]] int run_farm_run(const FarmRunOptions& options);

/// Atomically replaces the links in maps/, changes/ and reports/ by links to the newest results.
/// Throws io::FileError.
[[gnu::weak]] int run_farm_publish(const FarmPublishOptions& options);

/// Options of `orchard farm status DIR`.
struct FarmStatusOptions {
  std::string folder;
  bool json = false;
};

/// Prints finished results, results set aside with reasons, and open steps with their expected
/// cost. Throws io::FileError.
[[gnu::weak]] int run_farm_status(const FarmStatusOptions& options);

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
[[gnu::weak]] int run_farm_step(const FarmStepOptions& options);

}  // namespace orchard::cli
