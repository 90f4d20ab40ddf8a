// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace orchard::vision {

/// Version of the feature definitions; +1 with every change. Weights learnt with another version
/// must not be used.
inline constexpr int kAppearanceVersion = 2;

/// Names of the features of a window and the bands beside it. Brightness, red and blue are the logs
/// of a pixel's luma, of red over green and of blue over green.
inline constexpr std::array kAppearanceFeatureNames{
    // mean of the window less the mean of both bands
    "brightness_contrast", "red_contrast", "blue_contrast",
    // the smaller of the differences to the two bands, 0 if their signs differ
    "brightness_stands_out", "red_stands_out", "blue_stands_out",
    // mean of the window less that of its rows over the whole image
    "brightness_in_scene", "red_in_scene", "blue_in_scene",
    // absolute difference of the two bands
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
    // fraction of rows whose step has the same sign at the column of the steepest brightness step
    "step_agrees_weak", "step_agrees_strong",
    // middle against sides, and left half against right
    "brightness_bulge", "brightness_slant",
    // window against bands: spread of the row means; 90 % and 10 % quantiles of brightness
    "rows_spread", "brights_contrast", "darks_contrast"};

inline constexpr std::size_t kNumAppearanceFeatures = kAppearanceFeatureNames.size();

/// The feature values in the order of kAppearanceFeatureNames.
using AppearanceFeatures = std::array<double, kNumAppearanceFeatures>;

}  // namespace orchard::vision
