// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/observation_noise.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/statistics.hpp"

namespace orchard::pose {
namespace {

// derived: median of the chi-square distribution of 2 degrees of freedom, 2 ln 2. Wrong pairs of a
// few landmarks do not move a median.
constexpr double kMedianSquare = 1.3863;
// derived: three standard deviations of the median of n such squares, over the median itself: the
// density there is 1/4, so that each is 2 / sqrt(n).
constexpr double kThreeSigma = 3.0 * 2.0 / kMedianSquare;

PositionSum sum_of(const std::vector<PlacedObservation>& observations, std::size_t begin,
                   std::size_t end) {
  PositionSum sum;
  for (std::size_t i = begin; i < end; ++i) {
    sum.information += observations[i].position.information;
    sum.information_m += observations[i].position.information_m;
  }
  return sum;
}

}  // namespace

void ObservationScatter::add(const std::vector<PlacedObservation>& observations, double seen_m) {
  for (std::size_t begin = 0, end = 0; begin < observations.size(); begin = end) {
    end = begin + 1;
    while (end < observations.size() &&
           observations[end].travel_m - observations[end - 1].travel_m <= 2.0 * seen_m) {
      ++end;
    }
    if (end - begin < 2) continue;
    const std::size_t middle = begin + (end - begin) / 2;
    const PositionSum before = sum_of(observations, begin, middle);
    const PositionSum after = sum_of(observations, middle, end);
    const Eigen::Matrix2d P_before = before.information.inverse();
    const Eigen::Matrix2d P_after = after.information.inverse();
    const Eigen::Vector2d apart_m = P_after * after.information_m - P_before * before.information_m;
    const double square = apart_m.dot((P_before + P_after).inverse() * apart_m);
    if (std::isfinite(square)) squares_.push_back(square);
  }
}

double ObservationScatter::noise() const {
  if (squares_.empty()) return 1.0;
  const double surely = 1.0 - kThreeSigma / std::sqrt(static_cast<double>(squares_.size()));
  return std::max(1.0, surely * geometry::median(squares_) / kMedianSquare);
}

}  // namespace orchard::pose
