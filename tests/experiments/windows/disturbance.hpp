// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/pixel_block.hpp"

namespace orchard::evaluation {

/// A simulated change of light and camera for a picture.
struct Disturbance {
  double exposure_ev = 0.0;  ///< a factor of 2 in light per unit; clipped at white
  double red_gain = 1.0;     ///< gains of the light, like a wrong white balance
  double blue_gain = 1.0;
  double blur_px = 0.0;  ///< standard deviation of a Gaussian blur

  bool none() const {
    return exposure_ev == 0.0 && red_gain == 1.0 && blue_gain == 1.0 && blur_px == 0.0;
  }
};

/// Applies a disturbance to pixels; gains act on linear light (the sRGB curve is undone).
vision::PixelBlock disturbed(const vision::PixelBlock& pixels, const Disturbance& disturbance);

}  // namespace orchard::evaluation
