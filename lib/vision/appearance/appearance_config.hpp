// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "vision/appearance/appearance_features.hpp"

namespace orchard::vision {

/// Standardised features are clipped to this many standard deviations before they are squared.
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
