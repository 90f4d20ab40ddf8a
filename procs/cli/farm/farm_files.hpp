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
int run_farm_init(const FarmInitOptions& options);

/// Copies logs into the farm's folder; reports and skips logs that are already there. Throws
/// io::FileError, also if a different log has the same name.
int run_farm_add(const FarmAddOptions& options);

/// A file of config/farm, built into the program, that `farm init` writes.
struct ShippedFile {
  const char* name;
  const char* text;
};
extern const ShippedFile kFarmFiles[];
extern const int kNumFarmFiles;

}  // namespace orchard::cli
