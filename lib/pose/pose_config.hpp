// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// How base is placed in map. Section `pose`.
struct PoseConfig {
  bool use_odometry = true;  ///< dead reckoning between fixes
  bool use_fixes = true;     ///< POSE_FIX
  /// Rigs with neither: base stays at the map's origin, one pose per scan time is not needed.
  bool stationary = false;
  double fix_position_sd_m = 0.01;  ///< used when a fix states no covariance
  double fix_yaw_sd_rad = 0.01;
  double speed_sd_fraction = 0.03;       ///< odometry noise when it states no covariance
  double yaw_rate_sd_radps = 0.02;
  double odometry_timeout_s = 1.0;  ///< a longer gap is not dead-reckoned across
};

template <class Visitor>
void describe(Visitor& v, PoseConfig& c) {
  v.flag("use_odometry", c.use_odometry, "dead reckoning between fixes");
  v.flag("use_fixes", c.use_fixes, "positions on POSE_FIX");
  v.flag("stationary", c.stationary, "the robot stands still at the map's origin");
  v.number("fix_position_sd_m", c.fix_position_sd_m, 1e-6, 100, "m",
           "of a fix that states no covariance");
  v.number("fix_yaw_sd_rad", c.fix_yaw_sd_rad, 1e-6, 3.2, "rad",
           "of a fix that states no covariance");
  v.number("speed_sd_fraction", c.speed_sd_fraction, 0, 1, "1",
           "of odometry that states no covariance, per m/s");
  v.number("yaw_rate_sd_radps", c.yaw_rate_sd_radps, 0, 3.2, "rad/s",
           "of odometry that states no covariance");
  v.number("odometry_timeout_s", c.odometry_timeout_s, 0.001, 3600, "s",
           "a longer gap is not dead-reckoned across");
}

}  // namespace orchard::pose
