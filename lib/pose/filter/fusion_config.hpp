// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// How ODOMETRY, IMU, GNSS and POSE_FIX are fused. Section `pose.fusion`.
struct FusionConfig {
  bool use_imu = false;
  bool use_gnss = true;
  bool use_fixes = false;
  double speed_scale_sd = 0.05;         ///< of the wheels' size, found while driving
  double curvature_sd_per_m = 0.02;     ///< of unequal wheels or a bent steering, likewise
  double gyro_bias_sd_radps = 0.02;     ///< likewise
  double scale_walk_per_sqrt_m = 1e-4;  ///< how scale and curvature change with travel
  double gyro_walk_radps_per_sqrt_s = 1e-5;
  double noise_time_s = 0.1;       ///< for so long the error of a speed or yaw rate stays the same
  double gyro_sd_radps = 0.005;    ///< of an IMU that states no variance
  double silence_speed_mps = 1.5;  ///< what the robot may do while its wheels are not heard
  double silence_yaw_rate_radps = 0.5;
  double warn_sd_m = 0.5;  ///< a position less certain than this is a warning
};

template <class Visitor>
void describe(Visitor& v, FusionConfig& c) {
  v.flag("use_imu", c.use_imu, "IMU: its yaw rate instead of the wheels'");
  v.flag("use_gnss", c.use_gnss, "satellite fixes: section pose.gnss");
  v.flag("use_fixes", c.use_fixes, "external fixes");
  v.number("speed_scale_sd", c.speed_scale_sd, 0, 0.5, "1",
           "scale error of the wheels, which is found while driving");
  v.number("curvature_sd_per_m", c.curvature_sd_per_m, 0, 1, "1/m",
           "turn per metre by unequal wheels or a steering offset, found while driving");
  v.number("gyro_bias_sd_radps", c.gyro_bias_sd_radps, 0, 1, "rad/s",
           "bias of the IMU's yaw rate, found while driving");
  v.number("scale_walk_per_sqrt_m", c.scale_walk_per_sqrt_m, 0, 0.1, "1/sqrt(m)",
           "how scale and curvature wander with travel");
  v.number("gyro_walk_radps_per_sqrt_s", c.gyro_walk_radps_per_sqrt_s, 0, 0.1, "rad/s/sqrt(s)",
           "how the bias of the IMU's yaw rate wanders");
  v.number("noise_time_s", c.noise_time_s, 0.001, 10, "s",
           "for so long the error of a speed or yaw rate stays the same");
  v.number("gyro_sd_radps", c.gyro_sd_radps, 1e-6, 3, "rad/s",
           "yaw rate of an IMU that states no variance");
  v.number("silence_speed_mps", c.silence_speed_mps, 0, 50, "m/s",
           "standard deviation of the speed while the wheels are not heard");
  v.number("silence_yaw_rate_radps", c.silence_yaw_rate_radps, 0, 10, "rad/s",
           "of the yaw rate likewise");
  v.number("warn_sd_m", c.warn_sd_m, 0.001, 1000, "m",
           "a position less certain than this is a warning in STATUS");
}

}  // namespace orchard::pose
