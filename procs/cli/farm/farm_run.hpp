// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard farm run DIR`.
struct FarmRunOptions {
  std::string folder;
  std::string profile = "local";  ///< of profiles/
  int cores = 0;                  ///< 0: all of this machine, or as many as the profile says
};

/// `orchard farm publish DIR`.
struct FarmPublishOptions {
  std::string folder;
};

/// Makes what is not made yet, by Snakemake; then says the status. Exit code 1 when a step failed:
/// the rest is made nevertheless, and another run takes up what is left. Throws io::FileError.
int run_farm_run(const FarmRunOptions& options);

/// Makes maps/BLOCK/DATE and changes/BLOCK/DATE stand for the newest results, each in one moment.
/// Throws io::FileError.
int run_farm_publish(const FarmPublishOptions& options);

}  // namespace orchard::cli
