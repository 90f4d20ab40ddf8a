// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "vision/appearance_config.hpp"
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

/// The area that appearance_features() reads: the window's rows over the whole image width.
PixelRect appearance_reading_area(const PixelRect& window, const PixelRect& picture);

/// Computes colour, contrast, edge and texture features of a window relative to its surroundings at
/// the same height. The window spans the columns between a trunk's two edges.
///
/// `pixels` must be as wide as the image. Each colour channel is normalised by its mean over the
/// window and a band of the same width on either side, or over the whole rows, so exposure and
/// white balance cancel. A band outside the image is replaced by the mirrored other band. Rows of
/// the block outside the window have no influence. Throws std::invalid_argument when the window is
/// empty or does not lie inside the block.
AppearanceFeatures appearance_features(const PixelBlock& pixels, const PixelRect& window);

/// Log odds that a window shows a trunk. Throws as appearance_confidence() does.
double appearance_log_odds(const AppearanceFeatures& features, const AppearanceConfig& config);

/// Probability in [0, 1] that a window shows a trunk, for equal priors of trunk and background.
/// Throws std::invalid_argument when the model is not learnt.
double appearance_confidence(const AppearanceFeatures& features, const AppearanceConfig& config);

}  // namespace orchard::vision
