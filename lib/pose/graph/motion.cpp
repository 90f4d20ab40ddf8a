// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/motion.hpp"

#include "geometry/pose2.hpp"
#include "pose/arc_motion.hpp"
#include "pose/compose_covariance.hpp"

namespace orchard::pose {
using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;

Eigen::Vector3d RelativeMotion::delta_with(const OdometryCalibration& other) const {
  return delta + calibration_jacobian * (other - calibration);
}

void RelativeMotion::drive(double speed_mps, double yaw_rate_radps,
                           const std::array<double, 3>& velocity_covariance, double dt_s) {
  const double v_mps = (1.0 + calibration[0]) * speed_mps;
  const double w_radps = (1.0 + calibration[1]) * yaw_rate_radps - calibration[2];
  const Eigen::Matrix<double, 3, 2> J_velocity = arc_jacobian(v_mps, w_radps, dt_s);
  Eigen::Matrix<double, 2, 3> velocity_calibration;
  velocity_calibration << speed_mps, 0.0, 0.0, 0.0, yaw_rate_radps, -1.0;
  Eigen::Matrix2d Q;
  Q << velocity_covariance[0], velocity_covariance[1], velocity_covariance[1],
      velocity_covariance[2];
  const Eigen::Matrix3d F = compose_jacobian_second(delta);
  append(arc_motion(v_mps, w_radps, dt_s), J_velocity * Q * J_velocity.transpose());
  calibration_jacobian += F * J_velocity * velocity_calibration;
}

void RelativeMotion::append(const Eigen::Vector3d& T_now_next,
                            const Eigen::Matrix3d& step_covariance) {
  covariance = compose_covariance(delta, covariance, T_now_next, step_covariance);
  calibration_jacobian = compose_jacobian_first(delta, T_now_next) * calibration_jacobian;
  delta = compose(delta, T_now_next);
  travel_m += T_now_next.head<2>().norm();
}

}  // namespace orchard::pose
