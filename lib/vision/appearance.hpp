// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "vision/appearance_config.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

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
