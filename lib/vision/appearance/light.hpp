// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Mean colour of a window as logs; a change of light only shifts them (von Kries).
struct WindowLight {
  double blue = 0.0;   ///< ln blue over green
  double red = 0.0;    ///< ln red over green
  double green = 0.0;  ///< ln green, in grey levels
};

/// Mean colour of the window's pixels that are neither dark nor clipped; none when these are fewer
/// than a quarter. Throws std::invalid_argument when the window does not lie inside the block.
std::optional<WindowLight> window_light(const PixelBlock& pixels, const PixelRect& window);

}  // namespace orchard::vision
