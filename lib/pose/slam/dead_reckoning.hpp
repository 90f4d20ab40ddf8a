// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "pose/graph/motion.hpp"
#include "pose/measurements.hpp"
#include "pose/slam_config.hpp"

namespace orchard::pose {

/// Integrates odometry, or motion measured in its stead, since a time of the caller's choice.
/// Across a gap it extrapolates the last velocity with growing process noise.
class DeadReckoning {
 public:
  explicit DeadReckoning(const SlamConfig& config) : config_(config) {}

  /// Used for odometry that states no covariance.
  void set_default_noise(double speed_sd_fraction, double yaw_rate_sd_radps);

  /// Integrates to the odometry's time; its velocity is the mean since the reading before, as
  /// encoders measure it.
  void add(const Odometry& odometry);

  /// Appends a measured motion T_now_then up to `utime`.
  void add(std::int64_t utime, const Eigen::Vector3d& T_now_then,
           const Eigen::Matrix3d& covariance);

  /// Extrapolates to `utime` at the last velocity. Earlier times change nothing.
  void advance_to(std::int64_t utime);

  /// Starts a new motion here, with this odometry calibration.
  void restart(const OdometryCalibration& calibration);

  /// The velocity by other measurements, for a gap.
  void set_velocity(double speed_mps, double yaw_rate_radps);

  bool started() const { return utime_.has_value(); }
  std::int64_t utime() const { return utime_.value_or(0); }
  const RelativeMotion& motion() const { return motion_; }
  /// Time since the motion was last measured [s].
  double silence_s() const;
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
