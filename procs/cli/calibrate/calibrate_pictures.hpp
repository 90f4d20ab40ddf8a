// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/evaluate/mask_windows_reader.hpp"

namespace orchard::cli {

/// `orchard calibrate trunks --images DIR --masks DIR --out MODEL [--config RIG]`.
struct CalibratePicturesOptions {
  MaskedPictureOptions pictures;
  std::string config_path;  ///< rig to start from; empty: the defaults
  std::string out_path;     ///< empty: overwrites the rig and keeps the old one as .bak
};

/// Learns the appearance of trunks from pictures with masks and writes it into a rig's YAML, with
/// the hue interval of the same windows for comparison; returns the exit code. Throws io::FileError
/// and io::ConfigError, and then writes nothing.
int run_calibrate_pictures(const CalibratePicturesOptions& options);

}  // namespace orchard::cli
