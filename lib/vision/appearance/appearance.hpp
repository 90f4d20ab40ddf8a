// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/appearance/appearance_config.hpp"
#include "vision/appearance/appearance_features.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// What the features of a window read: its rows over the whole width of the picture.
PixelRect appearance_reading_area(const PixelRect& window, const PixelRect& picture);

/// Colour, contrast, edges and texture of a window - the columns between a trunk's two edges, over
/// some of its rows - beside what surrounds it at the same height.
///
/// `pixels` must be as wide as the picture. Every colour is measured against means over the same
/// rows, channel by channel, so that exposure and white balance cancel: of the window and a band
/// of its width on either side, and of the whole rows. A band beyond the picture is replaced by
/// the other one. Other rows of the block have no influence. Throws std::invalid_argument when
/// the window is empty or does not lie inside the block.
AppearanceFeatures appearance_features(const PixelBlock& pixels, const PixelRect& window);

/// Log of the odds that a window is a trunk's. Throws as appearance_confidence() does.
double appearance_log_odds(const AppearanceFeatures& features, const AppearanceConfig& config);

/// How likely a window is a trunk's, in [0, 1], where trunks and the rest are equally frequent.
/// Throws std::invalid_argument when the model is not learnt.
double appearance_confidence(const AppearanceFeatures& features, const AppearanceConfig& config);

}  // namespace orchard::vision
