// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Sharpness of an image, independent of its contrast.
struct Sharpness {
  /// Square root of gradient energy over variance of the brightness [1/px]: 2 pi / L for a wave of
  /// length L px; any blur lowers it. Corrected for codec and sensor noise of one grey level. 0 for
  /// a uniform area.
  double detail_per_px = 0.0;
  double clipped_fraction = 0.0;  ///< fraction of pixels that are all black or all white
};

/// Measures the sharpness of a block. All 0 for blocks less than 5 pixels wide or high.
Sharpness sharpness(const PixelBlock& block);

}  // namespace orchard::vision
