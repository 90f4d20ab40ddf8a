// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "evaluation/assignment.hpp"

namespace orchard::evaluation {

/// p_b = R(yaw) p_a + (x, y).
struct RigidMotion {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  Point operator()(const Point& p) const;
};

/// Rotation and translation that lay points upon points with the least squared distances (Umeyama
/// 1991 in the plane, without scale). One point gives a translation. Throws std::invalid_argument
/// for none or for unequal numbers.
RigidMotion fit_rigid(const std::vector<Point>& from, const std::vector<Point>& to);

}  // namespace orchard::evaluation
