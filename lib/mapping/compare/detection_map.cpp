// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/detection_map.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/statistics.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "pose/repeat_model.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kNumRanges = VisibilityGrid::kRangeEnds_m.size();
/// Quantile of the visibilities of a well visible tree.
constexpr double kSeenWell = 0.75;

using Rates = std::array<double, kNumRanges>;

/// Fits non-negative detection rates per distance bin to the observations per second of all trees
/// (least squares by coordinate descent: convex, few unknowns). Where the data do not separate
/// bins, the nearer one gets the rate.
Rates fit_rates(const std::vector<Rates>& fractions, const std::vector<double>& per_second) {
  constexpr int kSweeps = 300;
  Rates rates{};
  std::array<Rates, kNumRanges> products{};
  Rates targets{};
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    for (std::size_t j = 0; j < kNumRanges; ++j) {
      targets[j] += fractions[i][j] * per_second[i];
      for (std::size_t k = 0; k < kNumRanges; ++k)
        products[j][k] += fractions[i][j] * fractions[i][k];
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (std::size_t j = 0; j < kNumRanges; ++j) {
      if (products[j][j] <= 1e-9) continue;
      double rest = targets[j];
      for (std::size_t k = 0; k < kNumRanges; ++k) {
        if (k != j) rest -= products[j][k] * rates[k];
      }
      rates[j] = std::max(0.0, rest / products[j][j]);
    }
  }
  return rates;
}

}  // namespace

DetectionMap::DetectionMap(const std::vector<Landmark>& landmarks,
                           const std::vector<std::vector<pose::PoseEstimate>>& trajectories,
                           const SensorView& view) {
  if (trajectories.empty()) return;
  is_known_ = true;
  raster_.emplace_back(landmarks, trajectories, view);
  std::vector<Rates> fractions;
  std::vector<double> per_second;
  for (const Landmark& l : landmarks) {
    if (l.label == detection::Label::kObject) continue;
    const VisibilityGrid::Seconds observations = raster_.front().at({l.x_m, l.y_m});
    double total_s = 0.0;
    for (const float s : observations) total_s += s;
    if (total_s <= 0.0) continue;
    Rates fraction{};
    for (std::size_t j = 0; j < kNumRanges; ++j) fraction[j] = observations[j] / total_s;
    fractions.push_back(fraction);
    per_second.push_back(l.num_observations / total_s);
  }
  num_mapped_min_ = view.min_observations;
  rate_per_s_ = fit_rates(fractions, per_second);
  std::vector<double> deviations;
  for (const Landmark& l : landmarks) {
    const double expected = expected_observations({l.x_m, l.y_m});
    if (l.label == detection::Label::kObject || expected < 3.0) continue;
    deviations.push_back(l.num_observations / expected - 1.0);
  }
  std::vector<double> visibilities = deviations;
  for (double& v : visibilities) v += 1.0;
  if (!visibilities.empty()) {
    clear_visibility_ = std::max(1e-3, geometry::quantile(std::move(visibilities), kSeenWell));
  }
  // Assume a relative spread of at least one half, even if a small map shows less.
  const double spread = deviations.empty() ? 1.0 : geometry::robust_sd(std::move(deviations));
  shape_ = std::clamp(1.0 / std::max(1e-6, spread * spread), 0.5, 4.0);
}

double DetectionMap::expected_observations(const Vector2d& p_map) const {
  if (!is_known_) return 0.0;
  const VisibilityGrid::Seconds observations = raster_.front().at(p_map);
  double sum = 0.0;
  for (std::size_t j = 0; j < kNumRanges; ++j) sum += observations[j] * rate_per_s_[j];
  return sum;
}

double DetectionMap::visibility(const Landmark& landmark) const {
  const double expected = expected_observations({landmark.x_m, landmark.y_m});
  if (expected <= 0.0) return 1.0;
  return std::clamp(landmark.num_observations / expected, 0.1, 1.0);
}

double DetectionMap::rate(const Landmark& landmark) const {
  const double chances = clear_visibility_ * expected_observations({landmark.x_m, landmark.y_m});
  if (chances <= 0.0) return 1.0;
  return pose::detection_rate(landmark.num_observations, chances);
}

double DetectionMap::probability_mapped(const Vector2d& p_map, double rate) const {
  if (!is_known_) return 1.0;
  const double chances = clear_visibility_ * expected_observations(p_map);
  return chances <= 0.0 ? 0.0 : pose::probability_seen_again(rate, num_mapped_min_ / chances);
}

double DetectionMap::probability_missed(const Vector2d& p_map, const DetectionMap& other,
                                        const Landmark& of_other) const {
  const double observed = 1.0 - probability_missed(p_map, other.visibility(of_other));
  return 1.0 - observed * probability_mapped(p_map, other.rate(of_other));
}

double DetectionMap::probability_missed(const Vector2d& p_map, double visibility) const {
  if (!is_known_) return 1.0;
  return std::pow(1.0 + visibility * expected_observations(p_map) / shape_, -shape_);
}

}  // namespace orchard::mapping
