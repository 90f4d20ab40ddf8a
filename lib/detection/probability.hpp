// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "detection/detection.hpp"
#include "detection/probability_config.hpp"

namespace orchard::detection {

/// What kind of observation a detection is, and with that which weights speak about it.
enum class ViewKind {
  kJudged,     ///< a trunk to the laser, and judged
  kLaserOnly,  ///< the laser alone: UNSEEN but whole, or too far from a trunk's width to be looked
               ///< at
  kHidden,     ///< UNSEEN, and something nearer hides a side: nothing has judged it
};

/// Of a labelled detection; a rig without a camera labels everything it has whole.
ViewKind view_kind(const Detection& detection);

using ProbabilityFeatures = std::array<double, kNumJudgedFeatures>;

/// What is known of a detection as numbers of about one in size; see ProbabilityConfig for their
/// order. All from the message, so that a derived log suffices to learn from. Width z is signed:
/// from roc_laser = exp(-z^2 / 2) and the side of `width_mean_m` it lies on, within 5.
ProbabilityFeatures probability_features(const Detection& detection, double width_mean_m);

/// Probabilities of one observation; unknown is the rest to 1.
struct TreeProbability {
  double tree = 0.0;
  double object = 0.0;
};

/// Multinomial logistic regression over the features. Both 0 for kHidden and for a model that is
/// not enabled: unknown. Finite whatever the features.
TreeProbability tree_probability(const Detection& detection, double width_mean_m,
                                 const ProbabilityConfig& config);

}  // namespace orchard::detection
