// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/sway.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "geometry/statistics.hpp"
#include "mapping/existence/flicker.hpp"

namespace orchard::mapping {
namespace {

/// Quantile 0.999 of the standard normal distribution.
constexpr double kOneOfAThousand_sigma = 3.09;

/// Number of values less the two of the mean.
double degrees_of_freedom(std::size_t num_positions) {
  return 2.0 * (static_cast<double>(num_positions) - 1.0);
}

/// Chi-square of observed positions about their weighted mean.
double scatter(const ObservationStore& all, const std::vector<std::int32_t>& observations) {
  const auto weight = [&](std::int32_t k) { return 1.0 / geometry::square(all[k].sd_m); };
  Eigen::Vector2d sum(0.0, 0.0);
  double weights = 0.0, chi2 = 0.0;
  for (const std::int32_t k : observations) {
    sum += weight(k) * all.p_map(k);
    weights += weight(k);
  }
  for (const std::int32_t k : observations) {
    chi2 += weight(k) * (all.p_map(k) - sum / weights).squaredNorm();
  }
  return chi2;
}

/// Quantile of the chi-square distribution (Wilson and Hilferty 1931).
double chi_square_quantile(double freedom, double sigma) {
  const double spread = 2.0 / (9.0 * freedom);
  return freedom * std::pow(1.0 - spread + sigma * std::sqrt(spread), 3);
}

}  // namespace

SwayTest::SwayTest(const MapState& map) : map_(map) {
  std::vector<double> of_trees;
  for (std::int32_t i = 0; i < map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = map.landmarks[i];
    if (r.is_removed || label_of(r, map.config) != detection::Label::kTree) continue;
    const auto seen = map.observations.newest_of(r.last_observation, kStalkObservationsMax);
    if (seen.size() < 2) continue;
    of_trees.push_back(scatter(map.observations, seen) / degrees_of_freedom(seen.size()));
  }
  excess_ = std::max(1.0, geometry::median(std::move(of_trees)));
}

bool SwayTest::sways(const LandmarkRecord& record) const {
  const std::vector<std::int32_t> seen = stalk_observations(map_, record);
  if (seen.size() < 2) return false;
  return scatter(map_.observations, seen) >
         excess_ * chi_square_quantile(degrees_of_freedom(seen.size()), kOneOfAThousand_sigma);
}

}  // namespace orchard::mapping
