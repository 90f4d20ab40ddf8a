// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/pixel_block.hpp"

namespace orchard::evaluation {

/// What another light and another camera would have made of a picture.
struct Disturbance {
  double exposure_ev = 0.0;  ///< twice the light per step; what is too bright stays white
  double red_gain = 1.0;     ///< of the light, as a wrong white balance does it
  double blue_gain = 1.0;
  double blur_px = 0.0;  ///< standard deviation of a Gaussian

  bool none() const {
    return exposure_ev == 0.0 && red_gain == 1.0 && blue_gain == 1.0 && blur_px == 0.0;
  }
};

/// The pixels as they would have been: gains act on linear light (sRGB's curve undone).
vision::PixelBlock disturbed(const vision::PixelBlock& pixels, const Disturbance& disturbance);

}  // namespace orchard::evaluation
