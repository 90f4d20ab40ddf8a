// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "pose/graph/motion.hpp"
#include "pose/measurements.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Integrates odometry, or another measurement of the motion, since the last restart(). In a gap it
/// extrapolates at the last velocity with growing process noise.
class DeadReckoning {
 public:
  explicit DeadReckoning(const SlamConfig& config) : config_(config) {}

  /// Sets the noise of odometry without covariance.
  void set_default_noise(double speed_sd_fraction, double yaw_rate_sd_radps);

  /// Integrates up to the odometry's time. Its velocity is taken as the mean since the previous
  /// reading, as encoders measure it.
  void add(const Odometry& odometry);

  /// Appends a measured motion T_now_then, from the present time to `utime`.
  void add(std::int64_t utime, const Eigen::Vector3d& T_now_then,
           const Eigen::Matrix3d& covariance);

  /// Extrapolates to `utime` at the last velocity; does nothing for an earlier `utime`.
  void advance_to(std::int64_t utime);

  /// Starts a new motion at the present time, with this odometry calibration.
  void restart(const OdometryCalibration& calibration);

  /// Sets the velocity for extrapolation in a gap, from other measurements.
  void set_velocity(double speed_mps, double yaw_rate_radps);

  bool started() const { return utime_.has_value(); }
  std::int64_t utime() const { return utime_.value_or(0); }
  const RelativeMotion& motion() const { return motion_; }
  /// Returns the time since the motion was last measured [s].
  double time_since_motion_s() const;
  double speed_mps() const { return speed_mps_; }
  double yaw_rate_radps() const { return yaw_rate_radps_; }

 private:
  void drive_to(std::int64_t utime, double speed_mps, double yaw_rate_radps);

  SlamConfig config_;
  double speed_sd_fraction_ = 0.03;
  double yaw_rate_sd_radps_ = 0.02;
  std::optional<std::int64_t> utime_;
  std::optional<std::int64_t> started_utime_;
  std::optional<std::int64_t> measured_utime_;
  RelativeMotion motion_;
  double speed_mps_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  std::array<double, 3> velocity_covariance_{};
};

}  // namespace orchard::pose
