// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

namespace orchard::pose {

/// Slow errors of the wheels, learnt while driving: speed scale s, turn scale g, yaw rate bias b
/// [rad/s]; true speed = (1 + s) measured, true yaw rate = (1 + g) measured - b.
using WheelErrors = Eigen::Vector3d;

/// Motion of base between two times, T_then_now, with what it owes to the wheels' errors: made of
/// many small steps, so that the errors can change later without adding the steps up again.
struct RelativeMotion {
  Eigen::Vector3d delta = Eigen::Vector3d::Zero();           ///< with `errors` taken out
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();      ///< of delta
  Eigen::Matrix3d error_jacobian = Eigen::Matrix3d::Zero();  ///< d(delta) / d(errors)
  WheelErrors errors = WheelErrors::Zero();                  ///< that delta was made with
  double travel_m = 0.0;                                     ///< length of the path, >= 0

  /// delta as other errors of the wheels would make it, to first order.
  Eigen::Vector3d delta_with(const WheelErrors& other) const;

  /// Goes on for dt_s at the wheels' speed and yaw rate; velocity covariance: speed, cov, yaw rate.
  void drive(double speed_mps, double yaw_rate_radps, const std::array<double, 3>& covariance,
             double dt_s);

  /// Goes on by a measured motion T_now_next with its covariance, which owes nothing to wheels.
  void append(const Eigen::Vector3d& T_now_next, const Eigen::Matrix3d& covariance);
};

}  // namespace orchard::pose
