// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCore>
#include <optional>

namespace orchard::pose {

/// The entries of the inverse of a sparse, symmetric, positive definite matrix where the matrix
/// itself has entries (and more), without the rest of the inverse: marginal covariances of an
/// information matrix at the cost of factorising it once more. None if it is not positive definite.
///
/// Source: Takahashi, Fagan, Chen 1973, on Eigen's LDL^T.
std::optional<Eigen::SparseMatrix<double>> selected_inverse(
    const Eigen::SparseMatrix<double>& information);

}  // namespace orchard::pose
