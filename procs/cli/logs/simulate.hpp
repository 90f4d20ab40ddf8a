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
  std::string truth_path;         ///< CSV of what stands there; empty = do not write
  std::string poses_path;         ///< CSV of where base truly was; empty = do not write
  std::string observations_path;  ///< CSV of what each scan truly held; empty = do not write
  std::string config_path;        ///< empty = the scene's own rig
  double from_s = 0.0;            ///< the log begins so long after the scene
  double duration_s = 0.0;        ///< of the log; 0 = until the scene ends
};

/// Writes a log of a simulated drive, and its truth; returns the exit code. Equal options give
/// equal bytes. Throws io::FileError and io::ConfigError.
int run_simulate(const SimulateOptions& options);

}  // namespace orchard::cli
