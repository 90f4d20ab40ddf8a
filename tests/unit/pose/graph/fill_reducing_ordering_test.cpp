// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace orchard::pose {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Permutation = FillReducingOrdering::PermutationType;

/// A mesh of points, each coupled to those within `reach` columns and rows.
Matrix mesh(int columns, int rows, int reach) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int x = 0; x < columns; ++x) {
    for (int y = 0; y < rows; ++y) {
      for (int u = std::max(0, x - reach); u <= std::min(columns - 1, x + reach); ++u) {
        for (int v = std::max(0, y - reach); v <= std::min(rows - 1, y + reach); ++v) {
          const bool is_same = u == x && v == y;
          entries.emplace_back(x * rows + y, u * rows + v, is_same ? 100.0 : -1.0);
        }
      }
    }
  }
  Matrix matrix(columns * rows, columns * rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Permutation order_of(const Matrix& matrix) {
  Permutation order;
  FillReducingOrdering()(matrix, order);
  return order;
}

Permutation by_minimum_degree(const Matrix& matrix) {
  Permutation order;
  Eigen::AMDOrdering<int>()(matrix, order);
  return order;
}

// Two by two: the first column of the factor has one entry below its diagonal.
TEST(FillReducingOrdering, CountsTheWorkOfAFactor) {
  Permutation order(2);
  order.setIdentity();
  EXPECT_DOUBLE_EQ(factor_work(mesh(1, 2, 1), order), 1.0);
  // A dense one of n: 1 + 4 + ... + (n - 1)^2.
  Permutation of_six(6);
  of_six.setIdentity();
  EXPECT_DOUBLE_EQ(factor_work(mesh(2, 3, 2), of_six), 55.0);
}

TEST(FillReducingOrdering, OrdersEachUnknownOnceAndAlwaysTheSame) {
  const Matrix matrix = mesh(50, 40, 3);
  const Permutation order = order_of(matrix);
  const std::set<int> places(order.indices().data(), order.indices().data() + order.size());
  ASSERT_EQ(places.size(), 2000u);
  EXPECT_EQ(*places.begin(), 0);
  EXPECT_EQ(*places.rbegin(), 1999);
  EXPECT_EQ(order.indices(), order_of(matrix).indices());
}

// George 1973: nested dissection of a mesh of n x n points, each coupled to its eight neighbours,
// takes 829/84 n^3 multiplications, half a square of each column's entries.
TEST(FillReducingOrdering, DissectsAMeshAsWellAsGeorgeWhereMinimumDegreeDoesNot) {
  const int n = 100;
  const Matrix matrix = mesh(n, n, 1);
  const double by_george = 829.0 / 84.0 * std::pow(n, 3);
  EXPECT_LT(0.5 * factor_work(matrix, order_of(matrix)), by_george);
  EXPECT_GT(0.5 * factor_work(matrix, by_minimum_degree(matrix)), by_george);
}

TEST(FillReducingOrdering, LeavesAChainToMinimumDegree) {
  const Matrix matrix = mesh(3000, 1, 2);
  EXPECT_EQ(order_of(matrix).indices(), by_minimum_degree(matrix).indices());
}

}  // namespace
}  // namespace orchard::pose
