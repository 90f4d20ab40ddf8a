// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/selected_inverse.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace orchard::pose {

SelectedInverse::SelectedInverse(Ldlt&& factor)
    : diagonal_(factor.vectorD().size()), to_factor_(factor.permutationP().indices()) {
  lower_.swap(factor.lower());
  const int n = static_cast<int>(lower_.cols());
  std::vector<double> column(n, 0.0);  // column j of L, dense
  std::vector<double> sum(n, 0.0);
  std::vector<char> in_column(n, 0);
  const int* starts = lower_.outerIndexPtr();
  const int* rows = lower_.innerIndexPtr();
  double* inverse = lower_.valuePtr();  // columns up to j hold L, later ones the inverse Z
  // Z = D^-1 L^-1 + (1 - L^T) Z, from the last column to the first: the fill-in of the elimination
  // guarantees that every entry needed lies in the pattern of the columns already computed.
  for (int j = n - 1; j >= 0; --j) {
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      column[rows[e]] = inverse[e];
      in_column[rows[e]] = 1;
      sum[rows[e]] = 0.0;
    }
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      const int k = rows[e];
      const double value = column[k];
      sum[k] += diagonal_[k] * value;
      for (int f = starts[k]; f < starts[k + 1]; ++f) {
        const int i = rows[f];
        if (!in_column[i]) continue;
        sum[i] += inverse[f] * value;
        sum[k] += inverse[f] * column[i];
      }
    }
    diagonal_[j] = 1.0 / factor.vectorD()[j];
    for (int e = starts[j]; e < starts[j + 1]; ++e) {
      inverse[e] = -sum[rows[e]];
      diagonal_[j] -= column[rows[e]] * inverse[e];
      in_column[rows[e]] = 0;
    }
  }
}

double SelectedInverse::at(int row, int column) const {
  const int i = std::max(to_factor_[row], to_factor_[column]);
  const int j = std::min(to_factor_[row], to_factor_[column]);
  if (i == j) return diagonal_[i];
  const int* rows = lower_.innerIndexPtr();
  const int* begin = rows + lower_.outerIndexPtr()[j];
  const int* end = rows + lower_.outerIndexPtr()[j + 1];
  const int* at = std::lower_bound(begin, end, i);
  return at != end && *at == i ? lower_.valuePtr()[at - rows] : 0.0;
}

std::optional<SelectedInverse> selected_inverse(const Eigen::SparseMatrix<double>& information) {
  Ldlt factor;
  factor.compute(information);
  if (factor.info() != Eigen::Success || (factor.vectorD().array() <= 0.0).any()) {
    return std::nullopt;
  }
  return SelectedInverse(std::move(factor));
}

}  // namespace orchard::pose
