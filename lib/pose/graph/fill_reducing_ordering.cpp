// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/fill_reducing_ordering.hpp"

#include <metis.h>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <optional>
#include <utility>
#include <vector>

namespace orchard::pose {
namespace {

/// Finding an order by nested dissection takes as long as some hundred multiplications per entry
/// of the matrix.
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

}  // namespace orchard::pose
