// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/SparseCore>

namespace orchard::pose {

/// Order of elimination of a sparse symmetric matrix that leaves few entries in its factor: by
/// approximate minimum degree or, where that leaves much work, by nested dissection if this leaves
/// less. The graph of a long drive is a sheet, which nested dissection cuts where it is narrow; for
/// a chain of keyframes minimum degree is as good and sooner found. An ordering method of Eigen.
///
/// Sources: George 1973, Nested dissection of a regular finite element mesh; Karypis and Kumar
/// 1998, A fast and high quality multilevel scheme for partitioning irregular graphs (METIS).
class FillReducingOrdering {
 public:
  using PermutationType = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;

  /// `symmetric`: both triangles. `order`: from the matrix to the order of elimination.
  void operator()(const Eigen::SparseMatrix<double>& symmetric, PermutationType& order) const;
};

/// Returns the number of multiplications that factorising a matrix in this order takes.
double factor_work(const Eigen::SparseMatrix<double>& symmetric,
                   const FillReducingOrdering::PermutationType& order);

}  // namespace orchard::pose
