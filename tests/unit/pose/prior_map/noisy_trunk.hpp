// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "detection/detection.hpp"
#include "geometry/pose2.hpp"
#include "simulation/random.hpp"

namespace orchard::pose {
using geometry::rotation;

/// A trunk as a scanner truly has it before it.
struct TrunkInView {
  double range_m = 0.0;  ///< to its centre
  double bearing_rad = 0.0;
  double width_m = 0.0;
};

/// Standard deviations of what a scanner says of one trunk.
struct TrunkNoise {
  double range_sd_m = 0.0;
  double bearing_sd_rad = 0.0;
  double width_sd_m = 0.0;
  double width_sd_per_m = 0.0;  ///< of range, on top
};

/// What the scanner says of it, with the covariance that it states for that: a tree, its utime left
/// to the caller. Draws range, bearing and width, in this order. No width is under `width_min_m`.
inline detection::Detection noisy_trunk(const TrunkInView& trunk, const TrunkNoise& noise,
                                        double width_min_m, simulation::Random& random) {
  const double range_m = trunk.range_m + random.normal(0.0, noise.range_sd_m);
  const double bearing_rad = trunk.bearing_rad + random.normal(0.0, noise.bearing_sd_rad);
  detection::Detection seen;
  seen.centre_x_m = range_m * std::cos(bearing_rad);
  seen.centre_y_m = range_m * std::sin(bearing_rad);
  const Eigen::Matrix2d R = rotation(bearing_rad);
  const Eigen::Vector2d variances(noise.range_sd_m * noise.range_sd_m,
                                  std::pow(noise.bearing_sd_rad * range_m, 2));
  const Eigen::Matrix2d C = R * variances.asDiagonal() * R.transpose();
  seen.covariance = {C(0, 0), C(0, 1), C(1, 1)};
  seen.width_sd_m = noise.width_sd_m + noise.width_sd_per_m * range_m;
  seen.width_m = std::max(width_min_m, trunk.width_m + random.normal(0.0, seen.width_sd_m));
  seen.label = detection::Label::kTree;
  return seen;
}

}  // namespace orchard::pose
