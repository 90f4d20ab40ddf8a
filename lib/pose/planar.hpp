// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::pose {

/// Rotation by an angle [rad], counter-clockwise.
inline Eigen::Matrix2d rotation(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

/// T_a_b * p_b, with T_a_b as (x [m], y [m], yaw [rad]).
inline Eigen::Vector2d transform(const Eigen::Vector3d& T_a_b, const Eigen::Vector2d& p_b) {
  return rotation(T_a_b.z()) * p_b + T_a_b.head<2>();
}

/// inverse(T_a_b) * p_a.
inline Eigen::Vector2d transform_back(const Eigen::Vector3d& T_a_b, const Eigen::Vector2d& p_a) {
  return rotation(T_a_b.z()).transpose() * (p_a - T_a_b.head<2>());
}

/// T_a_b * T_b_c.
inline Eigen::Vector3d compose(const Eigen::Vector3d& T_a_b, const Eigen::Vector3d& T_b_c) {
  Eigen::Vector3d T_a_c;
  T_a_c.head<2>() = transform(T_a_b, T_b_c.head<2>());
  T_a_c.z() = geometry::wrap_angle_rad(T_a_b.z() + T_b_c.z());
  return T_a_c;
}

/// inverse(T_a_b) * T_a_c = T_b_c.
inline Eigen::Vector3d between(const Eigen::Vector3d& T_a_b, const Eigen::Vector3d& T_a_c) {
  Eigen::Vector3d T_b_c;
  T_b_c.head<2>() = transform_back(T_a_b, T_a_c.head<2>());
  T_b_c.z() = geometry::wrap_angle_rad(T_a_c.z() - T_a_b.z());
  return T_b_c;
}

/// d(T_a_b * T_b_c) / d(T_a_b), both as (x, y, yaw).
inline Eigen::Matrix3d compose_jacobian_first(const Eigen::Vector3d& T_a_b,
                                              const Eigen::Vector3d& T_b_c) {
  const Eigen::Vector2d moved = rotation(T_a_b.z()) * T_b_c.head<2>();
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F(0, 2) = -moved.y();
  F(1, 2) = moved.x();
  return F;
}

/// d(T_a_b * T_b_c) / d(T_b_c), both as (x, y, yaw).
inline Eigen::Matrix3d compose_jacobian_second(const Eigen::Vector3d& T_a_b) {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F.topLeftCorner<2, 2>() = rotation(T_a_b.z());
  return F;
}

/// Covariance of T_a_b * T_b_c when the errors of the two are independent.
inline Eigen::Matrix3d compose_covariance(const Eigen::Vector3d& T_a_b, const Eigen::Matrix3d& P_ab,
                                          const Eigen::Vector3d& T_b_c,
                                          const Eigen::Matrix3d& P_bc) {
  const Eigen::Matrix3d F1 = compose_jacobian_first(T_a_b, T_b_c);
  const Eigen::Matrix3d F2 = compose_jacobian_second(T_a_b);
  const Eigen::Matrix3d P = F1 * P_ab * F1.transpose() + F2 * P_bc * F2.transpose();
  return 0.5 * (P + P.transpose());
}

}  // namespace orchard::pose
