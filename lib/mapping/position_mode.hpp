// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// An observation in map with its weight.
struct WeightedPoint {
  Eigen::Vector2d p_map;
  double weight = 0.0;  ///< inverse variance [1 / m2]
};

/// Mode of a set of points.
struct PositionMode {
  Eigen::Vector2d p_map;
  Eigen::Matrix2d covariance;  ///< of p_map [m2]
};

/// Computes the mode of the points, weighted by inverse variance: mean shift from `start_map` with
/// a Gaussian kernel that shrinks to `kernel_m`, so that a few observations of another object do
/// not move the landmark. The covariance is that of the kernel-weighted mean with N - 1, N the
/// effective number of points; of a single point its own. Needs at least one point.
PositionMode position_mode(const std::vector<WeightedPoint>& points,
                           const Eigen::Vector2d& start_map, double kernel_m);

}  // namespace orchard::mapping
