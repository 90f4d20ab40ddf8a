// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// Options of `orchard farm run DIR`.
struct FarmRunOptions {
  std::string folder;
  std::string profile = "local";  ///< folder in profiles/
  int cores = 0;                  ///< 0: all cores of this machine, or the profile's number
};

/// Options of `orchard farm publish DIR`.
struct FarmPublishOptions {
  std::string folder;
};

/// Computes all missing results with Snakemake, then prints the status. Returns exit code 1 when a
/// step failed; the other steps are completed, and another run continues. Throws io::FileError.
int run_farm_run(const FarmRunOptions& options);

/// Atomically replaces the links in maps/, changes/ and reports/ by links to the newest results.
/// Throws io::FileError.
int run_farm_publish(const FarmPublishOptions& options);

}  // namespace orchard::cli
