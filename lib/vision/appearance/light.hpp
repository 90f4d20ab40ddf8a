// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// White-balance gains: factors of an image's channels that simulate another light.
struct ChannelGains {
  double blue = 1.0;
  double green = 1.0;
  double red = 1.0;

  bool none() const { return blue == 1.0 && green == 1.0 && red == 1.0; }
};

/// Mean colour of a window as logs; a change of light only shifts them (von Kries).
struct WindowLight {
  double blue = 0.0;   ///< ln blue over green
  double red = 0.0;    ///< ln red over green
  double green = 0.0;  ///< ln green, in grey levels
};

/// Multiplies the channels of a block by the gains; values saturate at 255.
void apply(const ChannelGains& gains, PixelBlock& pixels);

/// Mean colour of the window's pixels that are neither dark nor clipped; none when these are fewer
/// than a quarter. Throws std::invalid_argument when the window does not lie inside the block.
std::optional<WindowLight> window_light(const PixelBlock& pixels, const PixelRect& window);

}  // namespace orchard::vision
