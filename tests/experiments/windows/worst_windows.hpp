// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calibration/trunks/mask_windows.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::evaluation {

/// Keeps the worst errors of a model on windows and draws them on one sheet for the user.
class WorstWindows {
 public:
  void add(const std::string& picture, const vision::PixelBlock& pixels,
           const calibration::LabelledWindow& labelled, double confidence);

  /// Writes a PNG: three rows of false positives, worst first, then three of missed trunks; each
  /// window with its bands, picture and confidence. Throws io::FileError.
  void write(const std::string& path) const;

 private:
  struct Entry {
    double error = 0.0;  ///< error of the confidence
    std::string text;
    std::vector<std::uint8_t> bgr;  ///< kTile_px x kTile_px
  };
  std::array<std::vector<Entry>, 2> entries_;  ///< false positives, missed trunks; worst first
};

}  // namespace orchard::evaluation
