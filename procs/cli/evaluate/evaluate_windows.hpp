// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "cli/evaluate/mask_windows_reader.hpp"
#include "evaluation/disturbance.hpp"

namespace orchard::cli {

/// `orchard evaluate windows --images DIR --masks DIR --model MODEL`.
struct EvaluateWindowsOptions {
  MaskedPictureOptions pictures;
  std::string model_path;  ///< rig's YAML with a learnt detector.appearance
  evaluation::Disturbance disturbance;
  std::string worst_path;  ///< PNG of the worst mistakes; empty = none
  bool json = false;
};

/// Evaluates how well a model separates windows on trunks from other windows; returns the exit
/// code. Throws io::FileError and io::ConfigError.
int run_evaluate_windows(const EvaluateWindowsOptions& options);

}  // namespace orchard::cli
