// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace orchard::cli {

/// `orchard simulate --scene tubes|orchard|park|yard --seed N --out LOG`.
struct SimulateOptions {
  std::string scene;
  std::uint64_t seed = 1;
  std::string out_path;
  std::string truth_path;   ///< CSV of the true objects; empty: do not write
  std::string poses_path;   ///< CSV of the true poses of base; empty: do not write
  std::string config_path;  ///< empty: the scene's own rig
  double from_s = 0.0;      ///< start of the log in scene time
  double duration_s = 0.0;  ///< of the log; 0: until the end of the scene
};

/// Writes a log of a simulated drive, and its truth; returns the exit code. Equal options give
/// identical bytes. Throws io::FileError and io::ConfigError.
int run_simulate(const SimulateOptions& options);

}  // namespace orchard::cli
