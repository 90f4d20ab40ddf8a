// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "detection/detection.hpp"

namespace orchard::detection {

/// derived: number of features of detections of kind kJudged; see probability_features().
inline constexpr std::size_t kNumJudgedFeatures = 10;
/// derived: number of features of detections measured by the laser alone: the first ones of the
/// same list.
inline constexpr std::size_t kNumLaserFeatures = 6;

/// Weights of the regression from a detection's features to the probabilities of tree, object and
/// unknown. Section `detector.probability`. Written by `orchard calibrate trunks`.
///
/// The laser lists apply to detections of kind ViewKind::kLaserOnly, the judged lists to kJudged.
/// Order of each list: 1, width_z, width_z^2 / 5, range_m, log(beams / 10), hidden sides; judged
/// lists also: log odds of roc_colour, roc_colour is 0, roc_edges, roc_edges is 0.
struct ProbabilityConfig {
  bool enabled = false;
  std::vector<double> judged_tree;
  std::vector<double> judged_object;
  std::vector<double> laser_tree;
  std::vector<double> laser_object;
  double tree_min = 0.5;

  bool learnt() const { return !judged_tree.empty(); }
};

/// Whether the lists have consistent sizes: all empty, or one number per feature.
inline bool fits_features(const ProbabilityConfig& c) {
  const std::size_t judged = c.learnt() ? kNumJudgedFeatures : 0;
  const std::size_t laser = c.learnt() ? kNumLaserFeatures : 0;
  return c.judged_tree.size() == judged && c.judged_object.size() == judged &&
         c.laser_tree.size() == laser && c.laser_object.size() == laser;
}

template <class Visitor>
void describe(Visitor& v, ProbabilityConfig& c) {
  v.flag("enabled", c.enabled, "compute probability_tree and probability_object of each detection");
  v.number("tree_min", c.tree_min, 0.01, 0.99, "1",
           "min probability_tree of class TREE, for decision: probability");
  v.numbers("judged_tree", c.judged_tree, -1e3, 1e3, "1",
            "weights of the log odds of tree against unknown for: 1, width z, z^2 / 5, range in m, "
            "log(beams / 10), hidden sides, log odds of roc_colour, roc_colour is 0, roc_edges, "
            "roc_edges is 0");
  v.numbers("judged_object", c.judged_object, -1e3, 1e3, "1", "the same for object");
  v.numbers("laser_tree", c.laser_tree, -1e3, 1e3, "1",
            "weights for tree without a camera measurement: the first six features");
  v.numbers("laser_object", c.laser_object, -1e3, 1e3, "1", "the same for object");
  v.check(fits_features(c), "judged_tree",
          "the four lists must have 10, 10, 6 and 6 numbers, or all be empty; run `orchard "
          "calibrate trunks` again");
  v.check(!c.enabled || c.learnt(), "enabled",
          "needs weights; compute them with `orchard calibrate trunks`");
}

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
