// SPDX-License-Identifier: BSD-3-Clause
#include "detection/probability.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace orchard::detection {
namespace {

// derived: features beyond these limits tell no more.
constexpr double kZMax = 5.0;
constexpr double kLogOddsMax = 5.0;

double log_odds(double fraction) {
  if (fraction <= 0.0) return -kLogOddsMax;
  if (fraction >= 1.0) return kLogOddsMax;
  return std::clamp(std::log(fraction / (1.0 - fraction)), -kLogOddsMax, kLogOddsMax);
}

double score(const std::vector<double>& weights, const ProbabilityFeatures& features) {
  double sum = 0.0;
  for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * features[i];
  return sum;
}

/// derived: min roc_laser of candidates (three standard deviations: DetectorConfig::kRocLaserMin).
/// Shows whether the camera examined an object with roc_colour 0, because the message does not say.
constexpr float kRocLaserOfCandidates = 0.0111f;

}  // namespace

ViewKind view_kind(const Detection& d) {
  if (d.label != Label::kUnseen) {
    const bool looked_at = d.roc_colour > 0.0f || d.roc_laser >= kRocLaserOfCandidates;
    return looked_at ? ViewKind::kJudged : ViewKind::kLaserOnly;
  }
  return d.occlusion == 0 ? ViewKind::kLaserOnly : ViewKind::kHidden;
}

ProbabilityFeatures probability_features(const Detection& d, double width_mean_m) {
  const double z = d.roc_laser > 0.0f
                       ? std::min(kZMax, std::sqrt(std::max(0.0, -2.0 * std::log(d.roc_laser))))
                       : kZMax;
  const double hidden_sides =
      (d.occlusion & kOccludedRight ? 1.0 : 0.0) + (d.occlusion & kOccludedLeft ? 1.0 : 0.0);
  return {1.0,
          d.width_m < width_mean_m ? -z : z,
          0.2 * z * z,
          d.range_m,
          std::log(0.1 * std::max(1, d.num_beams)),
          hidden_sides,
          log_odds(d.roc_colour),
          d.roc_colour > 0.0f ? 0.0 : 1.0,
          d.roc_edges,
          d.roc_edges > 0.0f ? 0.0 : 1.0};
}

TreeProbability tree_probability(const Detection& d, double width_mean_m,
                                 const ProbabilityConfig& config) {
  const ViewKind view = view_kind(d);
  if (!config.enabled || view == ViewKind::kHidden) return {};
  const bool judged = view == ViewKind::kJudged;
  const ProbabilityFeatures features = probability_features(d, width_mean_m);
  const double tree = score(judged ? config.judged_tree : config.laser_tree, features);
  const double object = score(judged ? config.judged_object : config.laser_object, features);
  const double most = std::max({0.0, tree, object});  // avoids overflow of the exponentials
  const double e_tree = std::exp(tree - most), e_object = std::exp(object - most);
  const double sum = e_tree + e_object + std::exp(-most);
  return {e_tree / sum, e_object / sum};
}

}  // namespace orchard::detection
