// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace orchard::geometry {

inline constexpr double kPi = 3.14159265358979323846;  // derived: half a turn

/// Wraps an angle to (-pi, pi] [rad].
inline double wrap_angle_rad(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

/// Converts between our bearing (from the forward x axis, counter-clockwise) and the paper's (from
/// its forward Y axis towards X, clockwise seen from above) [rad]; its own inverse up to a full
/// turn. The paper's X points right and its Y forward (Shalal et al. 2013, figure 10).
inline double paper_bearing_rad(double bearing_rad) { return -bearing_rad; }

}  // namespace orchard::geometry
