// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace orchard::cli {

/// `orchard farm init DIR`.
struct FarmInitOptions {
  std::string folder;
  bool renew = false;  ///< write Snakefile and profiles anew, as this version has them
};

/// `orchard farm add DIR LOG...`.
struct FarmAddOptions {
  std::string folder;
  std::vector<std::string> log_paths;
  std::string block, date, robot;
};

/// Makes a farm's folder with its Snakefile and profiles; what is there stays as it is. Throws
/// io::FileError.
int run_farm_init(const FarmInitOptions& options);

/// Copies logs to where they belong; one that is there already is said and left. Throws
/// io::FileError, also where another log has the name.
int run_farm_add(const FarmAddOptions& options);

/// What `farm init` writes (config/farm).
struct ShippedFile {
  const char* name;
  const char* text;
};
extern const ShippedFile kFarmFiles[];
extern const int kNumFarmFiles;

}  // namespace orchard::cli
