// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <optional>

namespace orchard::pose {

/// L D L^T of a matrix of which the lower triangle is read; L can be written over.
class Ldlt : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
 public:
  /// Strictly lower; its diagonal is 1.
  Eigen::SparseMatrix<double>& lower() { return m_matrix; }
};

/// The entries of the inverse of a sparse, symmetric, positive definite matrix where the matrix
/// itself has entries (and more), without the rest of the inverse: marginal covariances of an
/// information matrix at the cost of factorising it once more, in the memory of the factor.
///
/// Source: Takahashi, Fagan, Chen 1973, on Eigen's LDL^T.
class SelectedInverse {
 public:
  /// Of a matrix that was decomposed, all of D above zero.
  explicit SelectedInverse(Ldlt&& factor);

  /// One entry; zero where neither the matrix nor its factor has one.
  double at(int row, int column) const;

 private:
  Eigen::SparseMatrix<double> lower_;  ///< of the inverse, in the factor's order
  Eigen::VectorXd diagonal_;
  Eigen::VectorXi to_factor_;
};

/// None if the matrix, of which the lower triangle is read, is not positive definite.
std::optional<SelectedInverse> selected_inverse(const Eigen::SparseMatrix<double>& information);

}  // namespace orchard::pose
