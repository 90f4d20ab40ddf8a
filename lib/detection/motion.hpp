// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

namespace orchard::detection {

/// How base moves about the time of a picture, from the wheels.
struct Motion {
  std::int64_t utime = 0;       ///< of the measurement [us]
  double speed_mps = 0.0;       ///< along base x
  double yaw_rate_radps = 0.0;  ///< about base z
};

/// A point of the plane, in the base or laser frame.
struct PlanePoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// Where a resting point is in base after base has moved for dt_s (either sign) with constant
/// speed and yaw rate.
inline PlanePoint after_motion(const PlanePoint& p_base, const Motion& motion, double dt_s) {
  const double turn_rad = motion.yaw_rate_radps * dt_s;
  const double way_m = motion.speed_mps * dt_s;
  // The chord of the arc that base drives, in the base frame before it.
  const double half_rad = 0.5 * turn_rad;
  const double chord_m = std::abs(half_rad) < 1e-9 ? way_m : way_m * std::sin(half_rad) / half_rad;
  const double x_m = p_base.x_m - chord_m * std::cos(half_rad);
  const double y_m = p_base.y_m - chord_m * std::sin(half_rad);
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  return {c * x_m + s * y_m, -s * x_m + c * y_m};
}

}  // namespace orchard::detection
