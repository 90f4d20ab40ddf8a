// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>

#include "pose/graph/fill_reducing_ordering.hpp"

namespace orchard::pose {

/// L D L^T factorisation, reading the lower triangle of a matrix; gives write access to L.
class Ldlt : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower,
                                          FillReducingOrdering> {
 public:
  /// L without its unit diagonal.
  Eigen::SparseMatrix<double>& lower() { return m_matrix; }
  /// Number of multiplications of a factorisation; call after analyzePattern().
  double work() const { return m_nonZerosPerCol.cast<double>().squaredNorm(); }
};

/// Selected inverse of a sparse, symmetric, positive definite matrix: only the entries of the
/// inverse within the pattern of its factor, which contains that of the matrix. It gives the
/// marginal covariances of an information matrix at the cost of one more factorisation, in the
/// memory of the factor.
///
/// Source: Takahashi, Fagan, Chen 1973, on Eigen's LDL^T.
class SelectedInverse {
 public:
  /// Inverts a factorised matrix; all of D must be positive.
  explicit SelectedInverse(Ldlt&& factor);

  /// Returns one entry of the inverse; zero outside the pattern of the factor.
  double at(int row, int column) const;

 private:
  Eigen::SparseMatrix<double> lower_;  ///< of the inverse, in the factor's order
  Eigen::VectorXd diagonal_;
  Eigen::VectorXi to_factor_;
};

/// Computes the selected inverse from the lower triangle of a matrix; none if it is not positive
/// definite.
std::optional<SelectedInverse> selected_inverse(const Eigen::SparseMatrix<double>& information);

}  // namespace orchard::pose
