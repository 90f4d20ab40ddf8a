// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// T_a_b in the plane: turns by yaw, then shifts.
struct RigidTransform {
  Eigen::Vector2d translation_m{0.0, 0.0};
  double yaw_rad = 0.0;

  Eigen::Matrix2d rotation() const;
  /// A point of frame b in frame a.
  Eigen::Vector2d apply(const Eigen::Vector2d& p_b) const;
  /// T_b_a.
  RigidTransform inverse() const;
};

/// T_a_c of T_a_b and T_b_c.
RigidTransform compose(const RigidTransform& T_a_b, const RigidTransform& T_b_c);

/// T_a_b that brings points of b nearest to those of a with the same index (least squares, each
/// pair weighted). Both [m], at least two pairs with distinct points. Umeyama 1991 in the plane.
RigidTransform fit_rigid(const std::vector<Eigen::Vector2d>& p_a,
                         const std::vector<Eigen::Vector2d>& p_b,
                         const std::vector<double>& weights);

}  // namespace orchard::mapping
