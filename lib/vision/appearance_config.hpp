// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace orchard::vision {

/// derived: version of the feature definitions; +1 with every change. Weights learnt with another
/// version must not be used.
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

/// derived: their number.
inline constexpr std::size_t kNumAppearanceFeatures = kAppearanceFeatureNames.size();

/// The feature values in the order of kAppearanceFeatureNames.
using AppearanceFeatures = std::array<double, kNumAppearanceFeatures>;

/// derived: 99.7 %; standardised features are clipped to this many standard deviations before they
/// are squared.
inline constexpr double kAppearanceSquareReach = 3.0;

/// Learnt appearance model of trunks against their surroundings: a logistic regression on
/// standardised features and, where that is better, on their squares. Section
/// `detector.appearance`. Written by `orchard calibrate trunks`; empty until then.
struct AppearanceConfig {
  int version = kAppearanceVersion;
  double confidence_min = 0.5;
  double bias = 0.0;
  std::vector<double> mean;
  std::vector<double> scale;
  std::vector<double> weights;
  /// Weight of each standardised feature's square less one; may be empty. Squares model features
  /// with medium values on bark: its texture lies between that of a post and that of leaves.
  std::vector<double> squares;

  bool learnt() const { return !weights.empty(); }
};

/// Whether the lists have consistent sizes: all empty, or one number per feature (squares may be
/// empty in either case).
inline bool fits_features(const AppearanceConfig& c) {
  const std::size_t size = c.learnt() ? kNumAppearanceFeatures : 0;
  return c.weights.size() == size && c.mean.size() == size && c.scale.size() == size &&
         (c.squares.empty() || c.squares.size() == size);
}

template <class Visitor>
void describe(Visitor& v, AppearanceConfig& c) {
  v.integer("version", c.version, 1, kAppearanceVersion, "1",
            "version of the features; with another version learn the model again");
  v.number("confidence_min", c.confidence_min, 0, 1, "1",
           "min confidence of a trunk; below it the edges are not searched");
  v.number("bias", c.bias, -1e3, 1e3, "1", "log odds of an average window");
  v.numbers("mean", c.mean, -1e6, 1e6, "1", "mean of each feature in the training data");
  v.numbers("scale", c.scale, 1e-9, 1e6, "1",
            "standard deviation of each feature in the training data");
  v.numbers("weights", c.weights, -1e3, 1e3, "1",
            "log odds per standard deviation of each feature");
  v.numbers("squares", c.squares, -1e3, 1e3, "1",
            "log odds per squared feature minus one (in standard deviations, at most 3); empty = "
            "not used");
  v.check(!c.learnt() || c.version == kAppearanceVersion, "version",
          "the model was learnt with other features; run `orchard calibrate trunks` again");
  v.check(fits_features(c), "weights",
          "mean, scale and weights must have one number per feature, or all be empty; squares as "
          "well, or be empty; run `orchard calibrate trunks` again");
}

}  // namespace orchard::vision
