// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace orchard::vision {

/// Counts up whenever a feature is added, dropped or measured otherwise: numbers learnt of other
/// features must not be used.
inline constexpr int kAppearanceVersion = 1;

/// What each number says of a window and of the bands beside it. Brightness, red and blue are logs
/// of a pixel's light, of red over green and of blue over green.
inline constexpr std::array kAppearanceFeatureNames{
    // how the window's mean differs from that of both bands
    "brightness_contrast", "red_contrast", "blue_contrast",
    // the smaller of the differences to either band, 0 where they point different ways
    "brightness_stands_out", "red_stands_out", "blue_stands_out",
    // the window's mean against that of its rows over the whole picture
    "brightness_in_scene", "red_in_scene", "blue_in_scene",
    // how the bands differ from one another
    "brightness_bands_differ", "red_bands_differ", "blue_bands_differ",
    // logs of standard deviations
    "brightness_spread", "red_spread", "blue_spread",  //
    "brightness_spread_beside", "red_spread_beside", "blue_spread_beside",
    // logs of mean gradients
    "gradient_across", "gradient_along", "gradient_across_beside", "gradient_along_beside",
    // fraction of the variance that lies between columns
    "brightness_in_columns", "blue_in_columns", "brightness_in_columns_beside",
    // steps of the column means at the window's sides: the weaker and the stronger side
    "brightness_step_weak", "brightness_step_strong", "colour_step_weak", "colour_step_strong",
    // fraction of rows whose step at that column has the same sign
    "step_agrees_weak", "step_agrees_strong",
    // middle against sides, and left half against right
    "brightness_bulge", "brightness_slant",
    // spread of row means, window against bands; quantiles, window against bands
    "rows_spread", "brights_contrast", "darks_contrast"};

inline constexpr std::size_t kNumAppearanceFeatures = kAppearanceFeatureNames.size();

/// One number per name, in that order.
using AppearanceFeatures = std::array<double, kNumAppearanceFeatures>;

}  // namespace orchard::vision
