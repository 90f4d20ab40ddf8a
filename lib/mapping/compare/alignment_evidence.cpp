// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/alignment_evidence.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "geometry/statistics.hpp"
#include "mapping/compare/change_posterior.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr double kOutlierFraction = 0.05;  ///< fraction of true pairs outside the noise model

double normal_density(double deviation, double sd) {
  const double u = deviation / sd;
  return std::exp(-0.5 * u * u) / (sd * std::sqrt(2.0 * geometry::kPi));
}

EvidenceDifference sum_of(const std::vector<double>& values) {
  EvidenceDifference d;
  for (const double v : values) d.log_odds += v;
  const auto n = static_cast<double>(values.size());
  double variance = 0.0;
  for (const double v : values) {
    variance += (v - d.log_odds / n) * (v - d.log_odds / n) * n / std::max(1.0, n - 1.0);
  }
  d.sigmas = variance > 0.0 ? d.log_odds / std::sqrt(variance) : (d.log_odds > 0.0 ? 1e3 : 0.0);
  return d;
}

}  // namespace

PairNoise pair_noise(const AlignmentTrunks& a, const AlignmentTrunks& b,
                     const std::vector<LandmarkPair>& pairs, double gate_m) {
  std::vector<LandmarkPair> corrected = pairs;
  remove_common_residuals(a.places, corrected);
  std::vector<double> deviations_m, width_changes_m;
  for (const LandmarkPair& pair : corrected) {
    deviations_m.push_back(pair.residual_m.x());
    deviations_m.push_back(pair.residual_m.y());
    width_changes_m.push_back(b.width_m[static_cast<std::size_t>(pair.b)] -
                              a.width_m[static_cast<std::size_t>(pair.a)]);
  }
  PairNoise noise;
  noise.gate_m = gate_m;
  noise.position_sd_m = std::max(0.01, geometry::robust_sd(std::move(deviations_m)));
  noise.width_offset_m = geometry::median(width_changes_m);
  for (double& change_m : width_changes_m) change_m -= noise.width_offset_m;
  noise.width_sd_m = std::max(0.003, geometry::robust_sd(std::move(width_changes_m)));
  noise.width_mean_m = geometry::median(b.width_m);
  std::vector<double> spread_m = b.width_m;
  for (double& width_m : spread_m) width_m -= noise.width_mean_m;
  noise.width_spread_m = std::max(noise.width_sd_m, geometry::robust_sd(std::move(spread_m)));
  return noise;
}

PairNoise null_noise(const std::vector<PairNoise>& of_hypotheses) {
  constexpr std::size_t kNumHypothesesMin = 4;
  PairNoise null = of_hypotheses.front();
  if (of_hypotheses.size() < kNumHypothesesMin) {
    null.position_sd_m = 0.5 * null.gate_m;  // uniform in a disc, per axis
    null.width_sd_m = std::max(null.width_sd_m, std::sqrt(2.0) * null.width_spread_m);
    return null;
  }
  std::vector<double> positions_m, widths_m;
  for (const PairNoise& noise : of_hypotheses) {
    positions_m.push_back(noise.position_sd_m);
    widths_m.push_back(noise.width_sd_m);
  }
  null.position_sd_m = geometry::median(std::move(positions_m));
  null.width_sd_m = geometry::median(std::move(widths_m));
  return null;
}

PairNoise shrunk_noise(const PairNoise& own, const PairNoise& null, std::size_t num_pairs) {
  constexpr double kNullPairs = 5.0;
  const auto n = static_cast<double>(num_pairs);
  const auto mixed = [&](double sd, double null_sd) {
    return std::sqrt((n * sd * sd + kNullPairs * null_sd * null_sd) / (n + kNullPairs));
  };
  PairNoise noise = own;
  noise.position_sd_m = mixed(own.position_sd_m, null.position_sd_m);
  noise.width_sd_m = mixed(own.width_sd_m, null.width_sd_m);
  return noise;
}

AlignmentEvidence evidence_of(const AlignmentTrunks& a, const AlignmentTrunks& b,
                              const AlignmentCandidate& candidate, const PairNoise& noise,
                              const PairNoise& null) {
  AlignmentEvidence evidence;
  evidence.of_a.assign(a.places.size(), 0.0);
  evidence.of_b.assign(b.places.size(), 0.0);
  std::vector<bool> a_is_paired(a.places.size(), false), b_is_paired(b.places.size(), false);
  const double anywhere = 1.0 / (geometry::kPi * noise.gate_m * noise.gate_m);
  const auto any_width = [&](std::size_t j) {
    return 0.9 * normal_density(b.width_m[j] - noise.width_mean_m, noise.width_spread_m) + 0.1;
  };
  // Mean log-likelihood of a pair under the null hypothesis.
  const double of_null = -3.0 * (0.5 + 0.5 * std::log(2.0 * geometry::kPi)) -
                         2.0 * std::log(null.position_sd_m) - std::log(null.width_sd_m);
  std::vector<LandmarkPair> pairs = candidate.pairs;
  remove_common_residuals(a.places, pairs);
  for (const LandmarkPair& pair : pairs) {
    const auto i = static_cast<std::size_t>(pair.a), j = static_cast<std::size_t>(pair.b);
    const double place = normal_density(pair.residual_m.x(), noise.position_sd_m) *
                         normal_density(pair.residual_m.y(), noise.position_sd_m);
    const double width =
        normal_density(b.width_m[j] - a.width_m[i] - noise.width_offset_m, noise.width_sd_m);
    a_is_paired[i] = b_is_paired[j] = true;
    evidence.num_judged_b += 1.0;
    evidence.of_b[j] =
        std::log((1.0 - kChangedFraction) * ((1.0 - kOutlierFraction) * place * width +
                                             kOutlierFraction * anywhere * any_width(j))) -
        of_null;
  }
  const geometry::Pose2 T_b_a = inverse(candidate.T_a_b);
  for (std::size_t i = 0; i < a.places.size(); ++i) {
    if (a_is_paired[i]) continue;
    const double missed = b.missed(transform(T_b_a, a.places[i]), *a.landmarks[i]);
    evidence.of_a[i] = std::log(kChangedFraction + (1.0 - kChangedFraction) * missed);
  }
  for (std::size_t j = 0; j < b.places.size(); ++j) {
    if (b_is_paired[j]) continue;
    const double missed = a.missed(transform(candidate.T_a_b, b.places[j]), *b.landmarks[j]);
    evidence.num_judged_b += 1.0 - missed;
    // New, or missed by the other drive; a missed one has the likelihood of the null hypothesis.
    evidence.of_b[j] = std::log(
        kChangedFraction * anywhere * any_width(j) * std::exp(-of_null) * (1.0 - missed) + missed);
  }
  return evidence;
}

EvidenceDifference compare_hypotheses(const AlignmentEvidence& first,
                                      const AlignmentEvidence& second) {
  std::vector<double> differences;
  const auto collect = [&](const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t i = 0; i < x.size(); ++i) differences.push_back(x[i] - y[i]);
  };
  collect(first.of_b, second.of_b);
  collect(first.of_a, second.of_a);
  return sum_of(differences);
}

EvidenceDifference log_odds_against_null(const AlignmentEvidence& evidence) {
  return sum_of(evidence.of_b);
}

double fraction_explained(const AlignmentEvidence& evidence, std::size_t num_pairs) {
  return evidence.num_judged_b <= 0.0 ? 0.0
                                      : static_cast<double>(num_pairs) / evidence.num_judged_b;
}

}  // namespace orchard::mapping
