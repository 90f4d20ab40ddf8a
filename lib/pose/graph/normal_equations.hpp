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

/// The matrix of normal equations, H = sum of J^T J, of unknowns that stand in blocks of two or
/// three: only its lower triangle is held, in one piece of memory.
class NormalEquations {
 public:
  /// Unknowns per block, each 1, 2 or 3.
  explicit NormalEquations(const std::vector<int>& sizes);

  /// Two blocks have an entry together. A block has one with itself.
  void couple(int a, int b);
  /// Numbers in H with what was coupled so far, duplicates counted once.
  std::size_t num_entries();
  /// No block is coupled any more; all entries are zero.
  void finish();

  void set_zero();
  /// Adds a product of derivatives, rows of block a and columns of block b, which were coupled; of
  /// a block with itself only the lower triangle counts.
  template <class Block>
  void add(int a, int b, const Block& block) {
    if (a < b) {
      add_below(b, a, block.transpose());
    } else {
      add_below(a, b, block);
    }
  }

  int num_unknowns() const { return first_.back(); }
  /// First unknown of a block.
  int first(int block) const { return first_[static_cast<std::size_t>(block)]; }
  int size(int block) const { return first(block + 1) - first(block); }
  double diagonal(int unknown) const { return H_.valuePtr()[H_.outerIndexPtr()[unknown]]; }
  void add_to_diagonal(int unknown, double value) {
    H_.valuePtr()[H_.outerIndexPtr()[unknown]] += value;
  }

  /// Decomposes H; false where it is not positive definite.
  bool factorise();
  /// H^-1 of a vector, once factorised.
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  /// The entries of H^-1 where H has some, and of H no more than the structure is kept: to be asked
  /// last. Once factorised.
  SelectedInverse inverse() &&;

 private:
  struct Below {
    int block = 0;
    int offset = 0;  ///< of its first row below the diagonal block, in the columns of another
  };
  const Below& find(int a, int b) const;

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
  std::vector<std::vector<Below>> below_;  ///< of each block: later ones, in rising order
  std::vector<std::size_t> num_sorted_;    ///< of those: in order and each once
  Eigen::SparseMatrix<double> H_;
  std::unique_ptr<Ldlt> factor_;
};

}  // namespace orchard::pose
