// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/normal_equations.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace orchard::pose {
namespace {

/// Number of couplings of a block that may be added before sorting out duplicates.
constexpr std::size_t kUnsortedMax = 64;

}  // namespace

NormalEquations::NormalEquations(const std::vector<int>& sizes)
    : first_{0}, below_(sizes.size()), num_sorted_(sizes.size(), 0) {
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

void NormalEquations::set_zero() { std::fill(H_.valuePtr(), H_.valuePtr() + H_.nonZeros(), 0.0); }

const NormalEquations::Below& NormalEquations::find(int a, int b) const {
  const std::vector<Below>& rows = below_[static_cast<std::size_t>(b)];
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
  analysed_factor().factorize(H_);
  return factor_->info() == Eigen::Success && (factor_->vectorD().array() > 0.0).all();
}

Eigen::VectorXd NormalEquations::solve(const Eigen::VectorXd& right) const {
  return factor_->solve(right);
}

SelectedInverse NormalEquations::inverse() && {
  H_ = {};
  return SelectedInverse(std::move(*factor_));
}

}  // namespace orchard::pose
