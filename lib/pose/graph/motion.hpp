// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

namespace orchard::pose {

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

  /// Returns delta for another calibration, to first order.
  Eigen::Vector3d delta_with(const OdometryCalibration& other) const;

  /// Integrates over dt_s at the measured speed and yaw rate. `covariance`: var speed, cov, var yaw
  /// rate.
  void drive(double speed_mps, double yaw_rate_radps, const std::array<double, 3>& covariance,
             double dt_s);

  /// Appends a measured motion T_now_next with its covariance, independent of the calibration.
  void append(const Eigen::Vector3d& T_now_next, const Eigen::Matrix3d& covariance);
};

}  // namespace orchard::pose
