// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// What the channels of a picture are multiplied by, to look as in another light.
struct ChannelGains {
  double blue = 1.0;
  double green = 1.0;
  double red = 1.0;

  bool none() const { return blue == 1.0 && green == 1.0 && red == 1.0; }
};

/// The colour of a window on the whole, as logs, which light only shifts (von Kries).
struct WindowLight {
  double blue = 0.0;   ///< ln blue over green
  double red = 0.0;    ///< ln red over green
  double green = 0.0;  ///< ln green, in grey levels
};

/// Multiplies the channels of a block; what gets too bright stays at 255.
void apply(const ChannelGains& gains, PixelBlock& pixels);

/// The mean colour of the window's pixels that are neither dark nor clipped, or none when fewer
/// than a quarter are. Throws std::invalid_argument when the window does not lie inside the block.
std::optional<WindowLight> window_light(const PixelBlock& pixels, const PixelRect& window);

}  // namespace orchard::vision
