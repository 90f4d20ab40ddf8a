// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// Options of `orchard farm publish DIR`, `verify` and `clean`.
struct FarmOptions {
  std::string folder;
};

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
  bool link = false;  ///< link to the logs instead of copying them
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
  bool dry_run = false;           ///< print the steps to make, and make none
};

/// Computes all missing results with Snakemake, then prints the status. Returns exit code 1 when a
/// step failed; the other steps are completed, and another run continues. Throws io::FileError.
[[gnu::weak]] int run_farm_run(const FarmRunOptions& options);

/// Atomically replaces the links in maps/, changes/ and reports/ by links to the newest results.
/// Throws io::FileError.
[[gnu::weak]] int run_farm_publish(const FarmOptions& options);

/// Prints results whose files were altered or deleted since they were made; then returns exit code
/// 3. Throws io::FileError.
[[gnu::weak]] int run_farm_verify(const FarmOptions& options);

/// Options of `orchard farm retry DIR [NAME]`.
struct FarmRetryOptions {
  std::string folder;
  std::string name;  ///< of a result, or "BLOCK/DATE/ROBOT/NAME"; empty: all that was set aside
};

/// Removes results and all that was made from them, so that the next run makes them again. Throws
/// io::FileError, before anything is removed, where corrections by hand would be lost.
[[gnu::weak]] int run_farm_retry(const FarmRetryOptions& options);

/// Removes results that no step of the farm needs and no link names, and what killed steps left, of
/// all machines. Throws io::FileError.
[[gnu::weak]] int run_farm_clean(const FarmOptions& options);

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
  std::string name;                  ///< of a lot, or of a result: results/NAME
  std::vector<std::string> command;  ///< instead of the step's own; "@out" in it is the folder
};

/// Makes a result, or all results of a lot that can be made: runs the command that computes it in a
/// temporary folder, and renames the folder when the command has ended. A result is therefore
/// complete or missing, even after a kill, and a function of the inputs that its name stands for:
/// they are compared with their digests before and after. Exit code 3 (bad input) sets the result
/// aside with the command's message; so does a crash, which would recur, unless a memory limit or a
/// file that cannot be mapped may be its cause. Any other failure, and inputs that have changed,
/// give no result and exit code 1; the other steps of a lot go on. Throws io::FileError.
[[gnu::weak]] int run_farm_step(const FarmStepOptions& options);

}  // namespace orchard::cli
