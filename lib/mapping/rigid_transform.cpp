// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rigid_transform.hpp"

#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::mapping {

using Eigen::Vector2d;

Eigen::Matrix2d RigidTransform::rotation() const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  Eigen::Matrix2d r;
  r << c, -s, s, c;
  return r;
}

Vector2d RigidTransform::apply(const Vector2d& p_b) const {
  return rotation() * p_b + translation_m;
}

RigidTransform RigidTransform::inverse() const {
  return {-(rotation().transpose() * translation_m), -yaw_rad};
}

RigidTransform compose(const RigidTransform& T_a_b, const RigidTransform& T_b_c) {
  return {T_a_b.apply(T_b_c.translation_m),
          geometry::wrap_angle_rad(T_a_b.yaw_rad + T_b_c.yaw_rad)};
}

RigidTransform fit_rigid(const std::vector<Vector2d>& p_a, const std::vector<Vector2d>& p_b,
                         const std::vector<double>& weights) {
  Vector2d mean_a(0.0, 0.0), mean_b(0.0, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < p_a.size(); ++i) {
    mean_a += weights[i] * p_a[i];
    mean_b += weights[i] * p_b[i];
    total += weights[i];
  }
  if (!(total > 0.0)) return {};
  mean_a /= total;
  mean_b /= total;
  double dot = 0.0, cross = 0.0;
  for (std::size_t i = 0; i < p_a.size(); ++i) {
    const Vector2d a = p_a[i] - mean_a, b = p_b[i] - mean_b;
    dot += weights[i] * (a.x() * b.x() + a.y() * b.y());
    cross += weights[i] * (b.x() * a.y() - b.y() * a.x());
  }
  RigidTransform T_a_b;
  T_a_b.yaw_rad = std::atan2(cross, dot);
  T_a_b.translation_m = mean_a - T_a_b.rotation() * mean_b;
  return T_a_b;
}

}  // namespace orchard::mapping
