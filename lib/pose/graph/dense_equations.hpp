// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace orchard::pose {

/// Dense matrix of normal equations of few unknowns in blocks; used as NormalEquations are.
class DenseEquations {
 public:
  explicit DenseEquations(const std::vector<int>& sizes) : first_{0} {
    for (const int size : sizes) first_.push_back(first_.back() + size);
  }

  void set_zero() { H_.setZero(num_unknowns(), num_unknowns()); }
  template <class Block>
  void add(int a, int b, const Block& block) {
    constexpr int kRows = Block::RowsAtCompileTime, kColumns = Block::ColsAtCompileTime;
    if (a < b) {
      H_.template block<kColumns, kRows>(first(b), first(a), size(b), size(a)) += block.transpose();
    } else {
      H_.template block<kRows, kColumns>(first(a), first(b), size(a), size(b)) += block;
    }
  }
  void add_to_diagonal(int unknown, double value) { H_(unknown, unknown) += value; }

  int num_unknowns() const { return first_.back(); }
  int first(int block) const { return first_[static_cast<std::size_t>(block)]; }
  int size(int block) const { return first(block + 1) - first(block); }

  bool factorise() {
    factor_.compute(H_);
    return factor_.info() == Eigen::Success;
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const { return factor_.solve(right); }
  Eigen::MatrixXd matrix() const { return H_.selfadjointView<Eigen::Lower>(); }

 private:
  std::vector<int> first_;
  Eigen::MatrixXd H_;  ///< lower triangle
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

}  // namespace orchard::pose
