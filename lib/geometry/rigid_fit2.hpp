// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::geometry {

/// A rigid motion fitted to pairs of points, with the moments of the points.
struct RigidFit2 {
  Pose2 T_a_b;
  Eigen::Vector2d mean_a{0.0, 0.0};  ///< weighted, [m]
  Eigen::Vector2d mean_b{0.0, 0.0};
  double mean_square_b_m2 = 0.0;  ///< weighted squared distance of b's points from their mean
};

/// Fits T_a_b by weighted least squares to pairs of points [m] with the same index; without weights
/// all count 1. One point, or coinciding points, give a translation; a sum of weights that is not
/// positive gives the identity. Throws std::invalid_argument for no points or unequal numbers.
///
/// Source: Umeyama 1991, "Least-squares estimation of transformation parameters between two point
/// patterns", in the plane and without scale, where the rotation is the angle of the summed
/// products. mrpt::tfest::se2_l2 takes no weights and keeps points as floats (figures in
/// README.md).
RigidFit2 fit_rigid(const std::vector<Eigen::Vector2d>& p_a,
                    const std::vector<Eigen::Vector2d>& p_b,
                    const std::vector<double>& weights = {});

/// T_a_b that maps the midpoint of (b1, b2) to that of (a1, a2) and aligns their directions: the
/// hypothesis of two correspondences.
Pose2 pose_from_two_pairs(const Eigen::Vector2d& a1, const Eigen::Vector2d& a2,
                          const Eigen::Vector2d& b1, const Eigen::Vector2d& b2);

}  // namespace orchard::geometry
