// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>

namespace orchard::detection {

/// Speed and yaw rate of base from ODOMETRY: the mean over the interval since the previous motion.
struct Motion {
  std::int64_t utime = 0;       ///< end of the interval [us]
  double speed_mps = 0.0;       ///< along base x
  double yaw_rate_radps = 0.0;  ///< about base z
};

/// derived: ten motions at 50 Hz; max time between a motion and the instant that it is used for.
inline constexpr std::int64_t kMotionAgeMax_us = 200'000;

/// From the points of a scan to the moment of its image: the motion of base from each beam to the
/// exposure, and Scan::plane_of_level.
///
/// Each beam is compensated from its own time: at 0.5 rad/s the last beam of a 75 ms sweep sees a
/// trunk 37 mrad (8 px at f = 222 px) away from where the first beam would. Both sides of an object
/// are moved by their own times, which leaves an error below half a pixel within the object. The
/// width is not compensated: the sweep turns at 60 rad/s, so a robot turning at 0.5 rad/s makes a
/// trunk 0.8 % wider or narrower, 1 mm of 125 mm.
struct ScanToPicture {
  std::optional<Motion> motion;  ///< none: as if it stood
  double first_beam_dt_s = 0.0;  ///< from the scan's first beam to the exposure
  double beam_period_s = 0.0;
  Eigen::Matrix2d plane_of_level = Eigen::Matrix2d::Identity();

  double dt_s(double beam) const { return first_beam_dt_s - beam * beam_period_s; }
};

/// A 2D point in the base or laser frame.
struct PlanePoint {
  double x_m = 0.0;
  double y_m = 0.0;
};

/// Position of a static point in base after base has moved for dt_s (either sign) with constant
/// speed and yaw rate.
inline PlanePoint after_motion(const PlanePoint& p_base, const Motion& motion, double dt_s) {
  const double turn_rad = motion.yaw_rate_radps * dt_s;
  const double way_m = motion.speed_mps * dt_s;
  // Chord of the arc driven by base, in the base frame at its start.
  const double half_rad = 0.5 * turn_rad;
  const double chord_m = std::abs(half_rad) < 1e-9 ? way_m : way_m * std::sin(half_rad) / half_rad;
  const double x_m = p_base.x_m - chord_m * std::cos(half_rad);
  const double y_m = p_base.y_m - chord_m * std::sin(half_rad);
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  return {c * x_m + s * y_m, -s * x_m + c * y_m};
}

}  // namespace orchard::detection
