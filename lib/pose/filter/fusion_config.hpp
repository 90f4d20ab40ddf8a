// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// Configuration of the fusion of ODOMETRY, IMU, GNSS and POSE_FIX. Section `pose.fusion`.
struct FusionConfig {
  bool use_imu = false;
  bool use_gnss = true;
  bool use_fixes = false;
  /// The wheels' lasting errors are estimated. Else each reading errs by itself, by what it states:
  /// what nothing can teach would only widen the gates of the mapping. Not a key: by pose.mode.
  bool learns_wheels = true;
  double speed_scale_sd = 0.05;
  double gyro_sd_radps = 0.005;
};

template <class Visitor>
void describe(Visitor& v, FusionConfig& c) {
  v.flag("use_imu", c.use_imu, "use the yaw rate of the IMU instead of that of the wheels");
  v.flag("use_gnss", c.use_gnss, "use GNSS; see section pose.gnss");
  v.flag("use_fixes", c.use_fixes, "use POSE_FIX");
  v.expert().number(
      "speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
      "prior standard deviation of the wheels' scale error, which is estimated while driving");
  v.expert().number(
      "gyro_sd_radps", c.gyro_sd_radps, 1e-6, 3, "rad/s",
      "standard deviation of the yaw rate of an IMU without variance; from the data sheet");
}

}  // namespace orchard::pose
