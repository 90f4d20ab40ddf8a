// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/bulk_centre.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

constexpr int kRounds = 12;

double kernel_weight(const WeightedPoint& point, const Eigen::Vector2d& centre, double kernel_m) {
  const double u2 = (point.p_map - centre).squaredNorm() / (kernel_m * kernel_m);
  return point.weight * std::exp(-0.5 * std::min(u2, 60.0));  // never 0: far points still lead
}

}  // namespace

BulkCentre bulk_centre(const std::vector<WeightedPoint>& points, const Eigen::Vector2d& start_map,
                       double kernel_m) {
  Eigen::Vector2d centre = start_map;
  double sum = 0.0;
  double sum2 = 0.0;
  for (int round = 0; round < kRounds; ++round) {
    const double round_kernel_m = kernel_m * std::max(1.0, 4.0 - 0.5 * round);
    Eigen::Vector2d next = Eigen::Vector2d::Zero();
    sum = sum2 = 0.0;
    for (const WeightedPoint& point : points) {
      const double weight = kernel_weight(point, centre, round_kernel_m);
      next += weight * point.p_map;
      sum += weight;
      sum2 += weight * weight;
    }
    centre = next / sum;
  }
  if (points.size() == 1) {
    return {centre, Eigen::Matrix2d::Identity() / points.front().weight};
  }
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const WeightedPoint& point : points) {
    const Eigen::Vector2d delta = point.p_map - centre;
    scatter += kernel_weight(point, centre, kernel_m) * delta * delta.transpose();
  }
  const double effective = std::max(1.0, sum * sum / sum2);
  scatter /= sum * std::max(1.0, effective - 1.0);
  return {centre, scatter};
}

}  // namespace orchard::mapping
