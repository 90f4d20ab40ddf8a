// SPDX-License-Identifier: BSD-3-Clause
#include "pose/arc_motion.hpp"

#include <cmath>

namespace orchard::pose {

Eigen::Vector3d arc_motion(double speed_mps, double yaw_rate_radps, double dt_s) {
  const double turn_rad = yaw_rate_radps * dt_s;
  const double length_m = speed_mps * dt_s;
  // sin(t)/t and (1-cos(t))/t; by their series for small t, where the quotients lose precision.
  const bool small = std::abs(turn_rad) < 1e-4;
  const double sinc = small ? 1.0 - turn_rad * turn_rad / 6.0 : std::sin(turn_rad) / turn_rad;
  const double cosc = small ? turn_rad / 2.0 : (1.0 - std::cos(turn_rad)) / turn_rad;
  return {length_m * sinc, length_m * cosc, turn_rad};
}

Eigen::Matrix<double, 3, 2> arc_jacobian(double speed_mps, double yaw_rate_radps, double dt_s) {
  const double half_turn_rad = 0.5 * yaw_rate_radps * dt_s;
  const double c = std::cos(half_turn_rad);
  const double s = std::sin(half_turn_rad);
  Eigen::Matrix<double, 3, 2> J;
  J << dt_s * c, -0.5 * speed_mps * dt_s * dt_s * s, dt_s * s, 0.5 * speed_mps * dt_s * dt_s * c,
      0.0, dt_s;
  return J;
}

}  // namespace orchard::pose
