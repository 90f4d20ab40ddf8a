// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/rigid_fit.hpp"

#include <cmath>
#include <stdexcept>

namespace orchard::evaluation {

Point RigidMotion::operator()(const Point& p) const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {x_m + c * p.x_m - s * p.y_m, y_m + s * p.x_m + c * p.y_m};
}

RigidMotion fit_rigid(const std::vector<Point>& from, const std::vector<Point>& to) {
  if (from.empty() || from.size() != to.size()) {
    throw std::invalid_argument("fit_rigid: wants as many points as points, and at least one");
  }
  const auto n = static_cast<double>(from.size());
  Point middle_from, middle_to;
  for (std::size_t i = 0; i < from.size(); ++i) {
    middle_from.x_m += from[i].x_m / n;
    middle_from.y_m += from[i].y_m / n;
    middle_to.x_m += to[i].x_m / n;
    middle_to.y_m += to[i].y_m / n;
  }
  double dot = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double ax = from[i].x_m - middle_from.x_m, ay = from[i].y_m - middle_from.y_m;
    const double bx = to[i].x_m - middle_to.x_m, by = to[i].y_m - middle_to.y_m;
    dot += ax * bx + ay * by;
    cross += ax * by - ay * bx;
  }
  RigidMotion motion;
  motion.yaw_rad = dot == 0.0 && cross == 0.0 ? 0.0 : std::atan2(cross, dot);
  const Point turned = motion(middle_from);
  motion.x_m = middle_to.x_m - turned.x_m;
  motion.y_m = middle_to.y_m - turned.y_m;
  return motion;
}

}  // namespace orchard::evaluation
