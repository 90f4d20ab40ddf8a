// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/alignment_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kShareChanged = 0.05;   ///< of trees between two drives, before looking
constexpr double kShareOutliers = 0.05;  ///< of pairs that are worse than the noise
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double normal_density(double deviation, double sd) {
  const double u = deviation / sd;
  return std::exp(-0.5 * u * u) / (sd * std::sqrt(2.0 * geometry::kPi));
}

/// Mean of a list and the variance of that mean.
struct Mean {
  double value = 0.0;
  double variance = 0.0;
};

Mean mean_of(const std::vector<double>& values) {
  Mean mean;
  if (values.empty()) return mean;
  const auto n = static_cast<double>(values.size());
  for (const double v : values) mean.value += v / n;
  for (const double v : values) {
    mean.variance += (v - mean.value) * (v - mean.value) / (n * std::max(1.0, n - 1.0));
  }
  return mean;
}

}  // namespace

PairNoise pair_noise(const AlignmentTrunks& a, const AlignmentTrunks& b,
                     const std::vector<LandmarkPair>& pairs, double gate_m) {
  std::vector<LandmarkPair> straightened = pairs;
  remove_common_residuals(a.places, straightened);
  std::vector<double> deviations_m, width_changes_m;
  for (const LandmarkPair& pair : straightened) {
    deviations_m.push_back(pair.residual_m.x());
    deviations_m.push_back(pair.residual_m.y());
    width_changes_m.push_back(b.width_m[static_cast<std::size_t>(pair.b)] -
                              a.width_m[static_cast<std::size_t>(pair.a)]);
  }
  PairNoise noise;
  noise.gate_m = gate_m;
  noise.position_sd_m = std::max(0.01, robust_sd(std::move(deviations_m)));
  noise.width_offset_m = median_of(width_changes_m);
  for (double& change_m : width_changes_m) change_m -= noise.width_offset_m;
  noise.width_sd_m = std::max(0.003, robust_sd(std::move(width_changes_m)));
  noise.width_mean_m = median_of(b.width_m);
  std::vector<double> spread_m = b.width_m;
  for (double& width_m : spread_m) width_m -= noise.width_mean_m;
  noise.width_spread_m = std::max(noise.width_sd_m, robust_sd(std::move(spread_m)));
  return noise;
}

AlignmentEvidence evidence_of(const AlignmentTrunks& a, const AlignmentTrunks& b,
                              const AlignmentCandidate& way, const PairNoise& noise) {
  AlignmentEvidence evidence;
  evidence.of_a.assign(a.places.size(), kNone);
  evidence.of_b.assign(b.places.size(), kNone);
  const double anywhere = 1.0 / (geometry::kPi * noise.gate_m * noise.gate_m);
  const auto any_width = [&](std::size_t j) {
    return 0.9 * normal_density(b.width_m[j] - noise.width_mean_m, noise.width_spread_m) + 0.1;
  };
  std::vector<LandmarkPair> pairs = way.pairs;
  remove_common_residuals(a.places, pairs);
  for (const LandmarkPair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
    const double place = normal_density(pair.residual_m.x(), noise.position_sd_m) *
                         normal_density(pair.residual_m.y(), noise.position_sd_m);
    const double width =
        normal_density(b.width_m[j] - a.width_m[i] - noise.width_offset_m, noise.width_sd_m);
    evidence.of_a[i] = 0.0;
    evidence.of_b[j] = std::log((1.0 - kShareChanged) * ((1.0 - kShareOutliers) * place * width +
                                                         kShareOutliers * anywhere * any_width(j)));
  }
  const RigidTransform T_b_a = way.T_a_b.inverse();
  for (std::size_t i = 0; i < a.places.size(); ++i) {
    if (std::isnan(evidence.of_a[i]) && b.is_looked_at(T_b_a.apply(a.places[i]))) {
      evidence.of_a[i] = std::log(kShareChanged);
    }
  }
  for (std::size_t j = 0; j < b.places.size(); ++j) {
    if (std::isnan(evidence.of_b[j]) && a.is_looked_at(way.T_a_b.apply(b.places[j]))) {
      evidence.of_b[j] = std::log(kShareChanged * anywhere * any_width(j));
    }
  }
  return evidence;
}

EvidenceDifference difference(const AlignmentEvidence& first, const AlignmentEvidence& second) {
  std::vector<double> both, only_first, only_second;
  const auto collect = [&](const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      if (!std::isnan(x[i]) && !std::isnan(y[i])) {
        both.push_back(x[i] - y[i]);
      } else if (!std::isnan(x[i])) {
        only_first.push_back(x[i]);
      } else if (!std::isnan(y[i])) {
        only_second.push_back(y[i]);
      }
    }
  };
  collect(first.of_b, second.of_b);
  const std::size_t num_both_b = both.size();
  const std::size_t num_only = std::min(only_first.size(), only_second.size());
  collect(first.of_a, second.of_a);
  EvidenceDifference d;
  if (2 * num_both_b >= num_only) {
    const Mean mean = mean_of(both);
    d.log_odds = mean.value * static_cast<double>(both.size());
    d.sigmas = mean.variance > 0.0 ? mean.value / std::sqrt(mean.variance)
                                   : (mean.value > 0.0 ? 1e3 : 0.0);
    return d;
  }
  // They lay different trunks upon each other: what they explain, they must explain as well.
  std::vector<double> of_first, of_second;
  for (const double v : first.of_b) {
    if (!std::isnan(v)) of_first.push_back(v);
  }
  for (const double v : second.of_b) {
    if (!std::isnan(v)) of_second.push_back(v);
  }
  const Mean mean_first = mean_of(of_first), mean_second = mean_of(of_second);
  const double better = mean_first.value - mean_second.value;
  d.log_odds = better * static_cast<double>(std::min(of_first.size(), of_second.size()));
  d.sigmas = better / std::sqrt(std::max(1e-12, mean_first.variance + mean_second.variance));
  return d;
}

double share_explained(const AlignmentEvidence& evidence, std::size_t num_pairs) {
  const auto num_judged = std::count_if(evidence.of_b.begin(), evidence.of_b.end(),
                                        [](double v) { return !std::isnan(v); });
  return num_judged == 0 ? 0.0 : static_cast<double>(num_pairs) / static_cast<double>(num_judged);
}

}  // namespace orchard::mapping
