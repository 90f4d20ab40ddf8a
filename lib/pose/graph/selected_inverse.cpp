// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/selected_inverse.hpp"

#include <Eigen/SparseCholesky>
#include <vector>

namespace orchard::pose {

std::optional<Eigen::SparseMatrix<double>> selected_inverse(
    const Eigen::SparseMatrix<double>& information) {
  using Matrix = Eigen::SparseMatrix<double>;
  const Eigen::SimplicialLDLT<Matrix> factor(information);
  if (factor.info() != Eigen::Success || (factor.vectorD().array() <= 0.0).any()) {
    return std::nullopt;
  }
  const Matrix& L = factor.matrixL().nestedExpression();  // strictly lower; its diagonal is 1
  const int n = static_cast<int>(L.cols());
  Matrix Z = L;
  Eigen::VectorXd diagonal(n);
  std::vector<double> column(n, 0.0);  // of L, spread out
  std::vector<double> sum(n, 0.0);
  std::vector<char> in_column(n, 0);
  const int* starts = L.outerIndexPtr();
  const int* rows = L.innerIndexPtr();
  const double* values = L.valuePtr();
  double* inverse = Z.valuePtr();
  // Z = D^-1 L^-1 + (1 - L^T) Z, from the last column to the first: whatever a column needs lies in
  // the pattern of columns that are done, because elimination filled it in.
  for (int j = n - 1; j >= 0; --j) {
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      column[rows[e]] = values[e];
      in_column[rows[e]] = 1;
      sum[rows[e]] = 0.0;
    }
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      const int k = rows[e];
      sum[k] += diagonal[k] * values[e];
      for (int f = starts[k]; f < starts[k + 1]; ++f) {
        const int i = rows[f];
        if (!in_column[i]) continue;
        sum[i] += inverse[f] * values[e];
        sum[k] += inverse[f] * column[i];
      }
    }
    diagonal[j] = 1.0 / factor.vectorD()[j];
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      inverse[e] = -sum[rows[e]];
      diagonal[j] -= values[e] * inverse[e];
      in_column[rows[e]] = 0;
    }
  }
  // back to the order of the caller
  const Eigen::VectorXi& to_factor = factor.permutationP().indices();
  Eigen::VectorXi to_caller(n);
  for (int i = 0; i < n; ++i) to_caller[to_factor[i]] = i;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * static_cast<std::size_t>(Z.nonZeros()) + n);
  for (int j = 0; j < n; ++j) {
    entries.emplace_back(to_caller[j], to_caller[j], diagonal[j]);
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      entries.emplace_back(to_caller[rows[e]], to_caller[j], inverse[e]);
      entries.emplace_back(to_caller[j], to_caller[rows[e]], inverse[e]);
    }
  }
  Matrix result(n, n);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

}  // namespace orchard::pose
