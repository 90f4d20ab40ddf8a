// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// physical: overexposures [EV] at which training windows are simulated, as a camera's exposure
/// control may leave them in the sun. Underexposure cancels in the features; clipping does not.
inline constexpr std::array kLearntExposures_ev{0.0, 1.0, 2.0};

/// Lookup table of a channel for `gain` times the light: linearises the sRGB value, multiplies,
/// clips at white and encodes it again.
std::array<std::uint8_t, 256> exposure_curve(double gain);

/// physical: mean light of a well-exposed picture, as a fraction of what saturates the sensor: ISO
/// 12232, saturation-based speed.
inline constexpr double kMeteredLight = 0.127;

/// Brightens underexposed pixels in linear light to a mean of kMeteredLight. The sRGB curve is
/// steeper for dark values, so dividing encoded values by their mean leaves larger contrasts in the
/// dark. Others stay as they are: clipped values cannot be restored, nor contrasts of a nearly
/// black picture.
void normalise_exposure(PixelBlock& pixels);

/// Simulates another exposure of the pixels, `exposure_ev` [EV] brighter. Clipped pixels have lost
/// their true value, so a darker exposure cannot be simulated correctly.
PixelBlock exposed(const PixelBlock& pixels, double exposure_ev);

/// The pixels as a model learns them: as it judges them (normalise_exposure()), and at each
/// overexposure of kLearntExposures_ev, in that order.
std::vector<PixelBlock> learnt_exposures(PixelBlock pixels);

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
