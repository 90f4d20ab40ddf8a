// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calibration/trunks/mask_windows.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::cli {

/// Keeps the windows that a model judges worst and draws them on one sheet, for a person.
class WorstWindows {
 public:
  void add(const std::string& picture, const vision::PixelBlock& pixels,
           const calibration::LabelledWindow& labelled, double confidence);

  /// A PNG: three rows of windows elsewhere that were taken for trunks, worst first, then three of
  /// trunks that were not; each with its bands, picture and confidence. Throws io::FileError.
  void write(const std::string& path) const;

 private:
  struct Entry {
    double error = 0.0;  ///< of the confidence
    std::string text;
    std::vector<std::uint8_t> bgr;  ///< kTile_px x kTile_px
  };
  std::array<std::vector<Entry>, 2> entries_;  ///< elsewhere, on trunks; worst first
};

}  // namespace orchard::cli
