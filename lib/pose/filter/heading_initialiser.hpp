// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace orchard::pose {

/// Pose of a dead-reckoned frame in map, T_map_local.
struct LocalFrame {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();
  double yaw_variance = 0.0;       ///< [rad2]
  double position_variance = 0.0;  ///< at centre_local_m, the centre of the points, per axis [m2]
  Eigen::Vector2d centre_local_m = Eigen::Vector2d::Zero();
};

/// Finds the first heading from positions: once the robot has travelled the baseline, its
/// dead-reckoned path is registered to the measured positions.
class HeadingInitialiser {
 public:
  explicit HeadingInitialiser(double baseline_m) : baseline_m_(baseline_m) {}

  /// Adds a pair of positions of one point (the antenna): dead-reckoned, and measured with that
  /// variance [m2 per axis]. Returns the frame once the points spread over the baseline and over
  /// six standard deviations (the stated one, or that of the residuals if larger). If many points
  /// still do not fit, the older half is dropped.
  std::optional<LocalFrame> add(const Eigen::Vector2d& p_local_m, const Eigen::Vector2d& p_map_m,
                                double variance_m2);

 private:
  struct Pair {
    Eigen::Vector2d p_local_m;
    Eigen::Vector2d p_map_m;
    double variance_m2;
  };

  double baseline_m_;
  std::vector<Pair> pairs_;
};

}  // namespace orchard::pose
