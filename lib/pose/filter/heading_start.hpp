// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace orchard::pose {

/// Where a dead-reckoned frame lies in map: T_map_local.
struct LocalFrame {
  Eigen::Vector3d x_y_yaw = Eigen::Vector3d::Zero();
  double yaw_variance = 0.0;       ///< [rad2]
  double position_variance = 0.0;  ///< of the points' centre, per axis [m2]
  Eigen::Vector2d centre_local_m = Eigen::Vector2d::Zero();
};

/// A first heading from positions: the robot dead-reckons from anywhere, and once it has travelled
/// the baseline the path that it made is laid upon the positions that it was told.
class HeadingStart {
 public:
  explicit HeadingStart(double baseline_m) : baseline_m_(baseline_m) {}

  /// Where a point (the antenna) was by dead reckoning and by a position of that variance [m2 per
  /// axis]. The frame, once the points spread over the baseline and over six standard deviations:
  /// as stated, or as the two paths miss each other if that is more. Of too many points that never
  /// fit the older half is forgotten.
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
