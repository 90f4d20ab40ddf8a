// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// How fine what a picture shows is, whatever its contrast.
struct Sharpness {
  /// Root of gradient energy over variance of the brightness [1/px]: of a wave of length L px it is
  /// 2 pi / L, and blur of any cause lowers it. What a codec's and a sensor's noise of one grey
  /// level gives is taken off. 0 for an even area.
  double detail_per_px = 0.0;
  double clipped_fraction = 0.0;  ///< of pixels that are all black or all white
};

/// Of blocks less than 5 pixels wide or high: all 0.
Sharpness sharpness(const PixelBlock& block);

}  // namespace orchard::vision
