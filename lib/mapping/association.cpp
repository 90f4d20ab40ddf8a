// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/association.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

constexpr int kEstablished = 3;            ///< observations from which a landmark leads a scan
constexpr double kWidthRelativeSd = 0.15;  ///< of one thing seen from different sides

/// Cost of calling the candidate that landmark; none outside the gates.
std::optional<double> cost_of(const Candidate& c, const LandmarkRecord& r,
                              const MapperConfig& config) {
  const detection::Detection& d = *c.detection;
  const Eigen::Vector2d delta = c.p_aligned - r.anchor();
  if (delta.squaredNorm() > config.gate_m * config.gate_m) return std::nullopt;
  const double width_difference_m = d.width_m - r.width_m;
  if (std::abs(width_difference_m) > config.width_gate_m) return std::nullopt;
  Eigen::Matrix2d covariance = c.aligned_covariance;
  covariance.diagonal().array() += r.scatter_m2 + 1.0 / r.anchor_information;
  const double mahalanobis2 = delta.dot(covariance.inverse() * delta);
  if (mahalanobis2 > config.gate_sigma * config.gate_sigma) return std::nullopt;
  const double width_sd_m =
      std::hypot(d.width_sd_m, kWidthRelativeSd * std::max<double>(r.width_m, d.width_m));
  const double width_term = width_difference_m / std::max(width_sd_m, 1e-3);
  // the determinant keeps a vague landmark from winning by its vagueness
  return mahalanobis2 + std::log(covariance.determinant()) + std::min(9.0, width_term * width_term);
}

bool is_surer(const Pairing& a, const Pairing& b) {
  if (a.cost != b.cost) return a.cost < b.cost;
  return a.landmark != b.landmark ? a.landmark < b.landmark : a.candidate < b.candidate;
}

}  // namespace

Association associate(const std::vector<Candidate>& candidates, const LandmarkTable& landmarks,
                      const MapperConfig& config) {
  std::vector<Pairing> possible;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    landmarks.near(candidates[k].p_aligned, config.gate_m,
                   [&](std::int32_t i, const LandmarkRecord& r) {
                     const auto cost = cost_of(candidates[k], r, config);
                     if (cost) possible.push_back({*cost, i, k});
                   });
  }
  std::sort(possible.begin(), possible.end(), is_surer);
  Association association;
  association.is_explained.assign(candidates.size(), 0);
  std::vector<std::int32_t> taken;
  std::vector<char> is_paired(candidates.size(), 0);
  for (const Pairing& p : possible) {
    association.is_explained[p.candidate] = 1;
    if (is_paired[p.candidate]) continue;
    if (std::find(taken.begin(), taken.end(), p.landmark) != taken.end()) continue;
    taken.push_back(p.landmark);
    is_paired[p.candidate] = 1;
    association.pairs.push_back(p);
  }
  return association;
}

std::optional<Eigen::Vector2d> nearest_established(const LandmarkTable& landmarks,
                                                   const Eigen::Vector2d& p_map, double reach_m) {
  double best_m2 = reach_m * reach_m;
  std::optional<Eigen::Vector2d> best;
  landmarks.near(p_map, reach_m, [&](std::int32_t, const LandmarkRecord& r) {
    if (r.num_all < kEstablished || r.log_odds < 0.0f) return;
    const double distance_m2 = (r.anchor() - p_map).squaredNorm();
    if (distance_m2 < best_m2) {
      best_m2 = distance_m2;
      best = r.anchor();
    }
  });
  return best;
}

std::int32_t merge_partner(const LandmarkTable& landmarks, std::int32_t index,
                           const MapperConfig& config) {
  const LandmarkRecord& r = landmarks[index];
  std::int32_t best = -1;
  double best_m2 = config.merge_m * config.merge_m;
  landmarks.near(r.anchor(), config.merge_m, [&](std::int32_t i, const LandmarkRecord& other) {
    // two things in one scan are two things
    if (i == index || other.last_scan == r.last_scan) return;
    if (std::abs(other.width_m - r.width_m) > config.width_gate_m) return;
    const double distance_m2 = (other.anchor() - r.anchor()).squaredNorm();
    if (distance_m2 < best_m2 || (distance_m2 == best_m2 && best >= 0 && i < best)) {
      best_m2 = distance_m2;
      best = i;
    }
  });
  return best;
}

}  // namespace orchard::mapping
