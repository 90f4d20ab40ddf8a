// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"
#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// Something round that a laser may see.
struct Thing {
  Eigen::Vector2d p{0, 0};
  double width_m = 0.12;
};

/// Ranges from the first surfaces to that of rays, without noise: 769 beams of 0.352 degrees over
/// three quarters of a turn, up to 20 m, sent in 75 ms while base moves from T_map_base by
/// `velocity` (x, y, yaw per second in base).
inline laser::Scan beams_of(const std::vector<Thing>& things, const pose::PoseEstimate& T_map_base,
                            const laser::LaserConfig& laser,
                            const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero()) {
  laser::Scan scan;
  scan.utime = T_map_base.utime;
  scan.bearing_step_rad = geometry::kPi / 512;
  scan.bearing_min_rad = -384 * scan.bearing_step_rad;
  scan.beam_period_us = 75e3 / 769;
  scan.range_min_m = 0.05;
  scan.range_max_m = 20.0;
  for (int k = 0; k < 769; ++k) {
    const double time_s = 1e-6 * scan.beam_period_us * k;
    const double c = std::cos(T_map_base.yaw_rad), s = std::sin(T_map_base.yaw_rad);
    const Eigen::Vector2d way = time_s * velocity.head<2>();
    const double yaw_rad = T_map_base.yaw_rad + time_s * velocity.z();
    const double cl = std::cos(yaw_rad), sl = std::sin(yaw_rad);
    const Eigen::Vector2d from(
        T_map_base.x_m + c * way.x() - s * way.y() + cl * laser.mount_x_m - sl * laser.mount_y_m,
        T_map_base.y_m + s * way.x() + c * way.y() + sl * laser.mount_x_m + cl * laser.mount_y_m);
    const double bearing_rad = yaw_rad + laser.mount_yaw_rad + scan.bearing_rad(k);
    const Eigen::Vector2d towards(std::cos(bearing_rad), std::sin(bearing_rad));
    double nearest_m = 0.0;
    for (const Thing& thing : things) {
      const Eigen::Vector2d arm = thing.p - from;
      const double along_m = arm.dot(towards);
      const double across_m = arm.x() * towards.y() - arm.y() * towards.x();
      const double in2 = 0.25 * thing.width_m * thing.width_m - across_m * across_m;
      if (along_m <= 0.0 || in2 <= 0.0) continue;
      const double range_m = along_m - std::sqrt(in2);
      if (range_m <= scan.range_max_m && (nearest_m == 0.0 || range_m < nearest_m)) {
        nearest_m = range_m;
      }
    }
    scan.ranges_m.push_back(static_cast<float>(nearest_m));
  }
  return scan;
}

}  // namespace orchard::mapping
