// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/association.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mapping/extent/extent.hpp"
#include "mapping/tuning.hpp"

namespace orchard::mapping {
namespace {

/// derived: observations from which a landmark guides scan alignment: two may be clutter.
constexpr int kEstablished = 3;
/// derived: Log odds from which the presence or absence of a reflector is sure: one flash, or three
/// observations without.
constexpr double kSureOfReflector = 2.0;

/// Width difference in standard deviations.
double width_term(const detection::Detection& d, const LandmarkRecord& r) {
  const double sd_m =
      std::hypot(d.width_sd_m, tuning::kWidthRelativeSd * std::max<double>(r.width_m, d.width_m));
  return (d.width_m - r.width_m) / std::max(sd_m, 1e-3);
}

/// Cost of assigning the candidate to the landmark; none outside the gates.
std::optional<double> cost_of(const Candidate& c, const LandmarkRecord& r,
                              const MapperConfig& config) {
  const detection::Detection& d = *c.detection;
  if (r.is_clump && looks_like_a_tree(d)) return std::nullopt;  // a tree inside the clump
  const Eigen::Vector2d delta = c.p_aligned - r.association_position();
  if (delta.squaredNorm() > config.gate_m * config.gate_m) return std::nullopt;
  if (std::abs(d.width_m - r.width_m) > config.width_gate_m) return std::nullopt;
  Eigen::Matrix2d covariance = c.aligned_covariance;
  covariance.diagonal().array() += r.scatter_m2 + 1.0 / r.association_information;
  const double mahalanobis2 = delta.dot(covariance.inverse() * delta);
  if (mahalanobis2 > config.gate_sigma * config.gate_sigma) return std::nullopt;
  const double widths = width_term(d, r);
  // Without the determinant, a landmark with a large covariance would win because of it.
  return mahalanobis2 + std::log(covariance.determinant()) + std::min(9.0, widths * widths);
}

/// Relaxed-gate association: the nearest well-known landmark within gate_m of similar width, for a
/// candidate outside all regular gates. -1 if there is none or it is already paired in this scan.
std::int32_t relaxed_gate_match(const Candidate& c, const LandmarkTable& landmarks,
                                const std::vector<std::int32_t>& taken,
                                const MapperConfig& config) {
  std::int32_t nearest = -1;
  double nearest_m2 = config.gate_m * config.gate_m;
  landmarks.near(c.p_aligned, config.gate_m, [&](std::int32_t i, const LandmarkRecord& r) {
    if (r.num_all < tuning::kWellKnownObservations || std::abs(width_term(*c.detection, r)) > 3.0)
      return;
    if (std::abs(c.detection->width_m - r.width_m) > config.width_gate_m) return;
    const double distance_m2 = (c.p_aligned - r.association_position()).squaredNorm();
    if (distance_m2 > nearest_m2 || (distance_m2 == nearest_m2 && i > nearest)) return;
    nearest_m2 = distance_m2;
    nearest = i;
  });
  const bool is_taken = std::find(taken.begin(), taken.end(), nearest) != taken.end();
  return is_taken ? -1 : nearest;
}

/// Whether one of two landmarks carries a reflector and the other does not, surely: a pole and what
/// it stands at, which are one object in scans without a flash.
bool differ_by_reflector(const LandmarkRecord& a, const LandmarkRecord& b,
                         const MapperConfig& config) {
  return config.reflector_marks_tree && std::min(a.log_odds, b.log_odds) < -kSureOfReflector &&
         std::max(a.log_odds, b.log_odds) > kSureOfReflector;
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
  // A clump's parts differ from scan to scan, because each scan hits other leaves.
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (association.is_explained[k]) continue;
    const std::int32_t i = clump_around(landmarks, candidates[k], config);
    if (i < 0) continue;
    association.is_explained[k] = 1;
    if (std::find(taken.begin(), taken.end(), i) != taken.end()) continue;
    taken.push_back(i);
    association.pairs.push_back({0.0, i, k});
  }
  // A candidate just outside the gate of a tree that the scan does not observe otherwise is that
  // tree, partly occluded or seen with a pose error. A separate object would be observed beside the
  // tree.
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    if (association.is_explained[k]) continue;
    const std::int32_t i = relaxed_gate_match(candidates[k], landmarks, taken, config);
    if (i < 0) continue;
    association.is_explained[k] = 1;
    taken.push_back(i);
    association.pairs.push_back({0.0, i, k});
  }
  return association;
}

std::optional<Eigen::Vector2d> nearest_established(const LandmarkTable& landmarks,
                                                   const Eigen::Vector2d& p_map, double reach_m) {
  double best_m2 = reach_m * reach_m;
  std::optional<Eigen::Vector2d> best;
  landmarks.near(p_map, reach_m, [&](std::int32_t, const LandmarkRecord& r) {
    if (r.num_all < kEstablished || r.log_odds < 0.0f) return;
    const double distance_m2 = (r.association_position() - p_map).squaredNorm();
    if (distance_m2 < best_m2) {
      best_m2 = distance_m2;
      best = r.association_position();
    }
  });
  return best;
}

std::int32_t merge_partner(const LandmarkTable& landmarks, std::int32_t index,
                           const MapperConfig& config) {
  const LandmarkRecord& r = landmarks[index];
  std::int32_t best = -1;
  double best_m2 = config.merge_m * config.merge_m;
  landmarks.near(r.association_position(), config.merge_m,
                 [&](std::int32_t i, const LandmarkRecord& other) {
                   // two detections of one scan are two objects
                   if (i == index || other.last_scan == r.last_scan) return;
                   if (std::abs(other.width_m - r.width_m) > config.width_gate_m) return;
                   if (differ_by_reflector(r, other, config)) return;
                   const double distance_m2 =
                       (other.association_position() - r.association_position()).squaredNorm();
                   if (distance_m2 > best_m2 || (distance_m2 == best_m2 && (best < 0 || i > best)))
                     return;
                   best_m2 = distance_m2;
                   best = i;
                 });
  return best;
}

}  // namespace orchard::mapping
