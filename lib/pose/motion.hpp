// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "pose/measurements.hpp"
#include "pose/pose_config.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::pose {

/// Returns the exact motion T_before_after of base (x [m], y [m], yaw [rad]) over dt_s at constant
/// speed and yaw rate: an arc.
Eigen::Vector3d arc_motion(double speed_mps, double yaw_rate_radps, double dt_s);

/// Returns d(arc_motion) / d(speed, yaw rate), to first order in the turn: accurate enough to
/// propagate the noise of one interval.
Eigen::Matrix<double, 3, 2> arc_jacobian(double speed_mps, double yaw_rate_radps, double dt_s);

/// Returns a pose T_map_base (x [m], y [m], yaw [rad]) with its covariance as an estimate.
PoseEstimate pose_estimate(std::int64_t utime, const Eigen::Vector3d& T_map_base,
                           const Eigen::Matrix3d& covariance);

/// Covariance of T_a_b * T_b_c, all as (x [m], y [m], yaw [rad]), if the errors of the two are
/// independent; symmetric.
Eigen::Matrix3d compose_covariance(const Eigen::Vector3d& T_a_b, const Eigen::Matrix3d& P_ab,
                                   const Eigen::Vector3d& T_b_c, const Eigen::Matrix3d& P_bc);

/// Odometry calibration, estimated while driving: speed scale s, turn scale g, yaw rate bias b
/// [rad/s]; true speed = (1 + s) measured, true yaw rate = (1 + g) measured - b.
using OdometryCalibration = Eigen::Vector3d;

/// Motion of base between two times, T_then_now, preintegrated from many small steps, with its
/// derivative by the odometry calibration, so that a new calibration needs no new integration.
struct RelativeMotion {
  Eigen::Vector3d delta = Eigen::Vector3d::Zero();                 ///< integrated by `calibration`
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();            ///< of delta
  Eigen::Matrix3d calibration_jacobian = Eigen::Matrix3d::Zero();  ///< d(delta) / d(calibration)
  OdometryCalibration calibration = OdometryCalibration::Zero();   ///< linearisation point
  double travel_m = 0.0;                                           ///< length of the path, >= 0
  bool has_guess = false;  ///< of a part that neither wheels nor scans tell: delta may be far off

  /// Returns delta for another calibration, to first order.
  Eigen::Vector3d delta_with(const OdometryCalibration& other) const;

  /// Integrates over dt_s at the measured speed and yaw rate. `covariance`: var speed, cov, var yaw
  /// rate.
  void drive(double speed_mps, double yaw_rate_radps, const std::array<double, 3>& covariance,
             double dt_s);

  /// Appends a measured motion T_now_next with its covariance, and its derivative by the odometry
  /// calibration.
  void append(const Eigen::Vector3d& T_now_next, const Eigen::Matrix3d& covariance,
              const Eigen::Matrix3d& calibration_jacobian = Eigen::Matrix3d::Zero());
};

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

  /// Appends a measured motion, from the time of the last measurement to `utime`. `is_guess`: it
  /// takes the place of one that could not be measured. `calibration_jacobian`: its derivative by
  /// the calibration of the wheels that had a part in it, at none.
  void add(std::int64_t utime, const Eigen::Vector3d& T_measured_then,
           const Eigen::Matrix3d& covariance, bool is_guess = false,
           const Eigen::Matrix3d& calibration_jacobian = Eigen::Matrix3d::Zero());

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
  /// Returns speed [m/s] and yaw rate [rad/s] by a calibration of the wheels.
  Eigen::Vector2d velocity_with(const OdometryCalibration& calibration) const;

 private:
  void drive_to(std::int64_t utime, double speed_mps, double yaw_rate_radps);

  SlamConfig config_;
  double speed_sd_fraction_ = 0.03;
  double yaw_rate_sd_radps_ = 0.02;
  std::optional<std::int64_t> utime_;
  std::optional<std::int64_t> started_utime_;
  std::optional<std::int64_t> measured_utime_;
  std::int32_t seq_ = 0;  ///< of the newest reading
  RelativeMotion motion_;
  Eigen::Vector3d ahead_ = Eigen::Vector3d::Zero();  ///< extrapolated since the last measurement
  double speed_mps_ = 0.0;
  double yaw_rate_radps_ = 0.0;
  bool is_by_wheels_ = true;  ///< the velocity, which their calibration then corrects
  std::array<double, 3> velocity_covariance_{};
};

}  // namespace orchard::pose
