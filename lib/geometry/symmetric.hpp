// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace orchard::geometry {

// Decompositions of small symmetric matrices. Each takes the compiler seconds in every file that
// asks Eigen for it, and so is compiled here, once.

/// Returns the x of A x = b for a symmetric, positive or negative semidefinite A.
Eigen::Vector3d solve_symmetric(const Eigen::Matrix3d& A, const Eigen::Vector3d& b);

/// The axes of an ellipse or of a scatter in the plane.
struct Axes2 {
  Eigen::Vector2d values;      ///< eigenvalues, ascending
  Eigen::Matrix2d directions;  ///< eigenvectors of unit length, one per column
};

/// Returns the eigenvalues and eigenvectors of a symmetric matrix, in closed form.
Axes2 axes_of(const Eigen::Matrix2d& A);

}  // namespace orchard::geometry
