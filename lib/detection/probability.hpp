// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "detection/detection.hpp"
#include "detection/probability_config.hpp"

namespace orchard::detection {

/// Kind of an observation; selects the weights for its probabilities.
enum class ViewKind {
  kJudged,     ///< a trunk candidate that was judged (see view_kind())
  kLaserOnly,  ///< measured by the laser alone: fully visible but UNSEEN, or rejected by its width
  kHidden,     ///< UNSEEN with a hidden side: not judged by any sensor
};

/// The kind of a labelled detection. A rig without a camera labels every object that is not hidden.
ViewKind view_kind(const Detection& detection);

using ProbabilityFeatures = std::array<double, kNumJudgedFeatures>;

/// Features of a detection, scaled to about 1; see ProbabilityConfig for their order. They use only
/// fields of the message, so a derived log suffices for training. The width's z-score is computed
/// from roc_laser = exp(-z^2 / 2), with the sign of width_m - width_mean_m, limited to [-5, 5].
ProbabilityFeatures probability_features(const Detection& detection, double width_mean_m);

/// Probabilities of one observation; the remainder to 1 is that of unknown.
struct TreeProbability {
  double tree = 0.0;
  double object = 0.0;
};

/// Computes the probabilities by multinomial logistic regression over the features. Both are 0
/// (unknown) for kHidden and if the model is not enabled. Finite for any features.
TreeProbability tree_probability(const Detection& detection, double width_mean_m,
                                 const ProbabilityConfig& config);

}  // namespace orchard::detection
