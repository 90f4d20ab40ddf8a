// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/appearance_config.hpp"
#include "vision/appearance_features.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// What the features of a window read: the window and a band of its width on either side, as far
/// as the picture goes.
PixelRect appearance_reading_area(const PixelRect& window, const PixelRect& picture);

/// Colour, contrast, edges and texture of a window - the columns between a trunk's two edges, over
/// some of its rows - beside what surrounds it at the same height.
///
/// Every colour is measured against the mean of the window and its bands, channel by channel, so
/// that exposure, white balance and shade over all of it cancel. A band that the block does not
/// hold is replaced by the other one. Depends on no other pixels of the block. Throws
/// std::invalid_argument when the window is empty or does not lie inside the block.
AppearanceFeatures appearance_features(const PixelBlock& pixels, const PixelRect& window);

/// Log of the odds that a window is a trunk's. Throws as appearance_confidence() does.
double appearance_log_odds(const AppearanceFeatures& features, const AppearanceConfig& config);

/// How likely a window is a trunk's, in [0, 1], where trunks and the rest are equally frequent.
/// Throws std::invalid_argument when the model is not learnt.
double appearance_confidence(const AppearanceFeatures& features, const AppearanceConfig& config);

}  // namespace orchard::vision
