// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/normal_equations.hpp"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

namespace orchard::pose {
namespace {

/// derived: finding an order by nested dissection takes as long as some hundred multiplications per
/// entry of the matrix.
constexpr double kDissectionWork_per_entry = 100.0;

/// The pattern of a factor, without its numbers.
class FactorPattern : public Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower,
                                                  Eigen::NaturalOrdering<int>> {
 public:
  const Eigen::VectorXi& entries_per_column() const { return m_nonZerosPerCol; }
};

/// Returns none if METIS had no memory.
std::optional<FillReducingOrdering::PermutationType> dissected(
    const Eigen::SparseMatrix<double>& symmetric) {
  idx_t num = static_cast<idx_t>(symmetric.rows());
  std::vector<idx_t> starts{0}, neighbours, place_to_unknown(num), unknown_to_place(num);
  for (idx_t j = 0; j < num; ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(symmetric, j); entry; ++entry) {
      if (entry.row() != j) neighbours.push_back(static_cast<idx_t>(entry.row()));
    }
    starts.push_back(static_cast<idx_t>(neighbours.size()));
  }
  if (METIS_NodeND(&num, starts.data(), neighbours.data(), nullptr, nullptr,
                   place_to_unknown.data(), unknown_to_place.data()) != METIS_OK) {
    return std::nullopt;
  }
  FillReducingOrdering::PermutationType order(num);
  for (idx_t j = 0; j < num; ++j) order.indices()[unknown_to_place[j]] = j;
  return order;
}

/// Couplings of a block that may be added before duplicates are sorted out; derived: a kilobyte.
constexpr std::size_t kUnsortedMax = 64;

}  // namespace

double factor_work(const Eigen::SparseMatrix<double>& symmetric,
                   const FillReducingOrdering::PermutationType& order) {
  Eigen::SparseMatrix<double> permuted(symmetric.rows(), symmetric.cols());
  permuted.selfadjointView<Eigen::Lower>() =
      symmetric.selfadjointView<Eigen::Lower>().twistedBy(order.inverse().eval());
  FactorPattern factor;
  factor.analyzePattern(permuted);
  return factor.entries_per_column().cast<double>().squaredNorm();
}

void FillReducingOrdering::operator()(const Eigen::SparseMatrix<double>& symmetric,
                                      PermutationType& order) const {
  Eigen::AMDOrdering<int>()(symmetric, order);
  const double work = factor_work(symmetric, order);
  if (work < kDissectionWork_per_entry * static_cast<double>(symmetric.nonZeros())) return;
  std::optional<PermutationType> other = dissected(symmetric);
  if (other && factor_work(symmetric, *other) < work) order = *std::move(other);
}

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

NormalEquations::NormalEquations(const std::vector<int>& sizes, Storage storage)
    : first_{0},
      below_(sizes.size()),
      num_sorted_(sizes.size(), 0),
      is_dense_(storage == Storage::kDense) {
  for (const int size : sizes) first_.push_back(first_.back() + size);
}

void NormalEquations::couple(int a, int b) {
  if (a == b) return;
  const auto column = static_cast<std::size_t>(std::min(a, b));
  std::vector<Below>& rows = below_[column];
  rows.push_back({std::max(a, b), 0});
  if (rows.size() < 2 * num_sorted_[column] + kUnsortedMax) return;
  std::sort(rows.begin(), rows.end(),
            [](const Below& x, const Below& y) { return x.block < y.block; });
  rows.erase(std::unique(rows.begin(), rows.end(),
                         [](const Below& x, const Below& y) { return x.block == y.block; }),
             rows.end());
  num_sorted_[column] = rows.size();
}

std::size_t NormalEquations::num_entries() {
  std::size_t num = 0;
  for (std::size_t b = 0; b < below_.size(); ++b) {
    std::vector<Below>& rows = below_[b];
    std::sort(rows.begin(), rows.end(),
              [](const Below& x, const Below& y) { return x.block < y.block; });
    rows.erase(std::unique(rows.begin(), rows.end(),
                           [](const Below& x, const Below& y) { return x.block == y.block; }),
               rows.end());
    num_sorted_[b] = rows.size();
    const auto n = static_cast<std::size_t>(size(static_cast<int>(b)));
    num += n * (n + 1) / 2;
    for (const Below& row : rows) num += n * static_cast<std::size_t>(size(row.block));
  }
  return num;
}

void NormalEquations::finish() {
  const std::size_t num = num_entries();
  if (num > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw std::length_error("normal equations: too many entries");
  }
  H_.resize(num_unknowns(), num_unknowns());
  H_.resizeNonZeros(static_cast<Eigen::Index>(num));
  int* starts = H_.outerIndexPtr();
  int* rows = H_.innerIndexPtr();
  int next = 0;
  for (std::size_t b = 0; b < below_.size(); ++b) {
    const int block = static_cast<int>(b);
    below_[b].shrink_to_fit();
    int offset = 0;
    for (Below& below : below_[b]) {
      below.offset = offset;
      offset += size(below.block);
    }
    for (int j = 0; j < size(block); ++j) {
      starts[first(block) + j] = next;
      for (int i = j; i < size(block); ++i) rows[next++] = first(block) + i;
      for (const Below& below : below_[b]) {
        for (int i = 0; i < size(below.block); ++i) rows[next++] = first(below.block) + i;
      }
    }
  }
  starts[num_unknowns()] = next;
  set_zero();
}

void NormalEquations::set_zero() {
  if (is_dense_) dense_H_.setZero(num_unknowns(), num_unknowns());
  std::fill(H_.valuePtr(), H_.valuePtr() + H_.nonZeros(), 0.0);
}

const NormalEquations::Below& NormalEquations::find(int a, int b) const {
  const std::vector<Below>& rows = below_[b];
  const auto at = std::lower_bound(rows.begin(), rows.end(), a, [](const Below& below, int block) {
    return below.block < block;
  });
  if (at == rows.end() || at->block != a) throw std::logic_error("blocks that were not coupled");
  return *at;
}

/// Returns the factor, whose pattern does not change.
Ldlt& NormalEquations::analysed_factor() {
  if (!factor_) {
    factor_ = std::make_unique<Ldlt>();
    factor_->analyzePattern(H_);
  }
  return *factor_;
}

double NormalEquations::factor_work() { return analysed_factor().work(); }

bool NormalEquations::factorise() {
  if (is_dense_) return dense_factor_.compute(dense_H_).info() == Eigen::Success;
  analysed_factor().factorize(H_);
  return factor_->info() == Eigen::Success && (factor_->vectorD().array() > 0.0).all();
}

Eigen::VectorXd NormalEquations::solve(const Eigen::VectorXd& right) const {
  if (is_dense_) return dense_factor_.solve(right);
  return factor_->solve(right);
}

SelectedInverse NormalEquations::inverse() && {
  H_ = {};
  return SelectedInverse(std::move(*factor_));
}

}  // namespace orchard::pose
