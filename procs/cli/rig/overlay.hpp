// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard::cli {

/// `orchard overlay LOG --at TIME --out PNG`.
struct OverlayOptions {
  std::string log_path;
  double at = 0.0;          ///< seconds from the log's first message, or an absolute utime [us]
  std::string config_path;  ///< empty: the rig stored in the log
  std::string out_path;
};

/// Draws the scan points and the detector's results onto the picture nearest to a time; returns the
/// exit code. Throws io::FileError and io::ConfigError, and then writes nothing.
int run_overlay(const OverlayOptions& options);

}  // namespace orchard::cli
