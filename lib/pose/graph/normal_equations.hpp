// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "pose/graph/selected_inverse.hpp"

namespace orchard::pose {

/// Sparse matrix of normal equations, H = sum of J^T J, of unknowns in blocks of 1 to 3. Only the
/// lower triangle is stored, in one piece of memory.
class NormalEquations {
 public:
  /// Unknowns per block, each 1, 2 or 3.
  explicit NormalEquations(const std::vector<int>& sizes);

  /// Reserves the entry of two blocks; each block always has one with itself.
  void couple(int a, int b);
  /// Returns the number of coefficients in H for the blocks coupled so far, without duplicates.
  std::size_t num_entries();
  /// Completes the structure, with all entries zero; couple() must not be called afterwards. Throws
  /// std::length_error if there are too many entries.
  void finish();

  void set_zero();
  /// Adds a product of derivatives (rows of block a, columns of block b) to coupled blocks. For
  /// a == b only the lower triangle is used. Throws std::logic_error if not coupled.
  template <class Block>
  void add(int a, int b, const Block& block) {
    if (a < b) {
      add_below(b, a, block.transpose());
    } else {
      add_below(a, b, block);
    }
  }

  int num_unknowns() const { return first_.back(); }
  /// Returns the index of the first unknown of a block.
  int first(int block) const { return first_[static_cast<std::size_t>(block)]; }
  int size(int block) const { return first(block + 1) - first(block); }
  double diagonal(int unknown) const { return H_.valuePtr()[H_.outerIndexPtr()[unknown]]; }
  void add_to_diagonal(int unknown, double value) {
    H_.valuePtr()[H_.outerIndexPtr()[unknown]] += value;
  }

  /// Number of multiplications that each factorise() takes.
  double factor_work();
  /// Factorises H; returns false if it is not positive definite.
  bool factorise();
  /// Returns H^-1 times a vector; call after factorise().
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  /// Returns the entries of H^-1 where H has entries; call after factorise(). Consumes H and its
  /// factor, so it must be the last call.
  SelectedInverse inverse() &&;

 private:
  struct Below {
    int block = 0;
    int offset = 0;  ///< of its first row, counted below the diagonal block of the column
  };
  const Below& find(int a, int b) const;
  Ldlt& analysed_factor();

  template <class Block>
  void add_below(int a, int b, const Block& block) {
    double* values = H_.valuePtr();
    const int* starts = H_.outerIndexPtr();
    const int num_columns = size(b), num_rows = size(a);
    if (a == b) {
      for (int j = 0; j < num_columns; ++j) {
        double* column = values + starts[first(b) + j];
        for (int i = j; i < num_rows; ++i) column[i - j] += block(i, j);
      }
      return;
    }
    const int offset = find(a, b).offset;
    for (int j = 0; j < num_columns; ++j) {
      double* column = values + starts[first(b) + j] + (num_columns - j) + offset;
      for (int i = 0; i < num_rows; ++i) column[i] += block(i, j);
    }
  }

  std::vector<int> first_;
  std::vector<std::vector<Below>> below_;  ///< per block: coupled later blocks, ascending
  std::vector<std::size_t> num_sorted_;    ///< per block: how many of them are sorted and unique
  Eigen::SparseMatrix<double> H_;
  std::unique_ptr<Ldlt> factor_;
};

}  // namespace orchard::pose
