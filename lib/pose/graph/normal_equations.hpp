// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

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

/// Matrix of normal equations, H = sum of J^T J, of unknowns in blocks of 1 to 3: dense for few
/// unknowns; sparse for many, of which only the lower triangle is stored, in one piece of memory.
class NormalEquations {
 public:
  enum class Storage { kSparse, kDense };
  /// `sizes`: unknowns per block, each 1, 2 or 3.
  explicit NormalEquations(const std::vector<int>& sizes, Storage storage = Storage::kSparse);

  // Sparse only: structure and work.
  /// Reserves the entry of two blocks; each block always has one with itself.
  void couple(int a, int b);
  /// Returns the number of coefficients in H for the blocks coupled so far, without duplicates.
  std::size_t num_entries();
  /// Completes the structure, with all entries zero; couple() must not be called afterwards. Throws
  /// std::length_error if there are too many entries.
  void finish();
  /// Number of multiplications that each factorise() takes.
  double factor_work();
  /// Returns the entries of H^-1 where H has entries; call after factorise(). Consumes H and its
  /// factor, so it must be the last call.
  SelectedInverse inverse() &&;

  /// Returns all of a dense H.
  Eigen::MatrixXd matrix() const { return dense_H_.selfadjointView<Eigen::Lower>(); }

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
  int first(int block) const { return first_[block]; }
  int size(int block) const { return first(block + 1) - first(block); }
  void add_to_diagonal(int unknown, double value) {
    (is_dense_ ? dense_H_(unknown, unknown) : H_.valuePtr()[H_.outerIndexPtr()[unknown]]) += value;
  }

  /// Factorises H; returns false if it is not positive definite.
  bool factorise();
  /// Returns H^-1 times a vector; call after factorise().
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  struct Below {
    int block = 0;
    int offset = 0;  ///< of its first row, counted below the diagonal block of the column
  };
  const Below& find(int a, int b) const;
  Ldlt& analysed_factor();

  template <class Block>
  void add_below(int a, int b, const Block& block) {
    if (is_dense_) {
      // derived: of the type.
      constexpr int kRows = Block::RowsAtCompileTime, kColumns = Block::ColsAtCompileTime;
      dense_H_.block<kRows, kColumns>(first(a), first(b), size(a), size(b)) += block;
      return;
    }
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
  bool is_dense_;
  Eigen::MatrixXd dense_H_;  ///< lower triangle
  Eigen::LLT<Eigen::MatrixXd> dense_factor_;
};

}  // namespace orchard::pose
