// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "geometry/angles.hpp"

/// Poses and motions in the plane, SE(2): T_a_b transforms a point of frame b to frame a by a
/// rotation by yaw and a translation. Filters and solvers hold a pose as the vector (x [m], y [m],
/// yaw [rad]) that their covariances refer to; elsewhere Pose2 names the three numbers.
///
/// Why not mrpt::poses::CPose2D: README.md gives the reasons and figures. The test composes poses
/// with both and compares the results.
namespace orchard::geometry {

/// T_a_b; the pose T_map_base where the name says nothing else.
struct Pose2 {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  Eigen::Vector2d translation_m() const { return {x_m, y_m}; }
  Eigen::Vector3d vector() const { return {x_m, y_m, yaw_rad}; }
};

/// The pose of a vector (x [m], y [m], yaw [rad]).
inline Pose2 pose2_of(const Eigen::Vector3d& x_y_yaw) {
  return {x_y_yaw.x(), x_y_yaw.y(), x_y_yaw.z()};
}

/// Rotation by an angle [rad], counter-clockwise.
inline Eigen::Matrix2d rotation(double angle_rad) {
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}
inline Eigen::Matrix2d rotation(const Pose2& T_a_b) { return rotation(T_a_b.yaw_rad); }

/// T_a_b * p_b.
inline Eigen::Vector2d transform(const Eigen::Vector3d& T_a_b, const Eigen::Vector2d& p_b) {
  return rotation(T_a_b.z()) * p_b + T_a_b.head<2>();
}
inline Eigen::Vector2d transform(const Pose2& T_a_b, const Eigen::Vector2d& p_b) {
  return transform(T_a_b.vector(), p_b);
}

/// inverse(T_a_b) * p_a.
inline Eigen::Vector2d inverse_transform(const Eigen::Vector3d& T_a_b, const Eigen::Vector2d& p_a) {
  return rotation(T_a_b.z()).transpose() * (p_a - T_a_b.head<2>());
}
inline Eigen::Vector2d inverse_transform(const Pose2& T_a_b, const Eigen::Vector2d& p_a) {
  return inverse_transform(T_a_b.vector(), p_a);
}

/// T_b_a.
inline Eigen::Vector3d inverse(const Eigen::Vector3d& T_a_b) {
  Eigen::Vector3d T_b_a;
  T_b_a.head<2>() = -(rotation(T_a_b.z()).transpose() * T_a_b.head<2>());
  T_b_a.z() = wrap_angle_rad(-T_a_b.z());
  return T_b_a;
}
inline Pose2 inverse(const Pose2& T_a_b) { return pose2_of(inverse(T_a_b.vector())); }

/// T_a_b * T_b_c.
inline Eigen::Vector3d compose(const Eigen::Vector3d& T_a_b, const Eigen::Vector3d& T_b_c) {
  Eigen::Vector3d T_a_c;
  T_a_c.head<2>() = transform(T_a_b, T_b_c.head<2>());
  T_a_c.z() = wrap_angle_rad(T_a_b.z() + T_b_c.z());
  return T_a_c;
}
inline Pose2 compose(const Pose2& T_a_b, const Pose2& T_b_c) {
  return pose2_of(compose(T_a_b.vector(), T_b_c.vector()));
}

/// inverse(T_a_b) * T_a_c = T_b_c.
inline Eigen::Vector3d between(const Eigen::Vector3d& T_a_b, const Eigen::Vector3d& T_a_c) {
  Eigen::Vector3d T_b_c;
  T_b_c.head<2>() = inverse_transform(T_a_b, T_a_c.head<2>());
  T_b_c.z() = wrap_angle_rad(T_a_c.z() - T_a_b.z());
  return T_b_c;
}
inline Pose2 between(const Pose2& T_a_b, const Pose2& T_a_c) {
  return pose2_of(between(T_a_b.vector(), T_a_c.vector()));
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

/// Rotates the covariance (xx, xy, yy) of a point by an angle [rad].
inline std::array<double, 3> rotated_covariance(const std::array<double, 3>& covariance,
                                                double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const auto [xx, xy, yy] = covariance;
  return {c * c * xx - 2.0 * c * s * xy + s * s * yy, c * s * (xx - yy) + (c * c - s * s) * xy,
          s * s * xx + 2.0 * c * s * xy + c * c * yy};
}

/// d(T_a_b * p_b) / d(T_a_b) as (x, y, yaw). `arm_a`: the vector from the origin of b to the point,
/// in frame a.
inline Eigen::Matrix<double, 2, 3> point_jacobian(const Eigen::Vector2d& arm_a) {
  Eigen::Matrix<double, 2, 3> J;
  J << 1.0, 0.0, -arm_a.y(), 0.0, 1.0, arm_a.x();
  return J;
}

}  // namespace orchard::geometry
