// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "simulation/random.hpp"

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

Eigen::SparseMatrix<double> random_information(std::uint64_t seed, int n) {
  simulation::Random random(seed);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * n, n);
  for (int row = 0; row < J.rows(); ++row) {
    for (int i = 0; i < 3; ++i) {
      J(row, static_cast<int>(random.uniform() * n)) = random.normal();
    }
  }
  J.topRows(n) += Eigen::MatrixXd::Identity(n, n);
  return Eigen::MatrixXd(J.transpose() * J).sparseView();
}

TEST(SelectedInverse, IsTheDenseInverseWhereTheMatrixHasEntries) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Eigen::SparseMatrix<double> H = random_information(seed, 40);
    Ldlt factor;
    factor.compute(H);
    const SelectedInverse P(std::move(factor));
    const Eigen::MatrixXd dense = Eigen::MatrixXd(H).inverse();
    for (int j = 0; j < H.outerSize(); ++j) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(H, j); it; ++it) {
        EXPECT_NEAR(P.at(it.row(), it.col()), dense(it.row(), it.col()), 1e-9);
      }
    }
  }
}

struct Equations {
  NormalEquations sparse{{3, 2, 3, 1, 2}};
  NormalEquations few{{3, 2, 3, 1, 2}, NormalEquations::Storage::kDense};
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(11, 11);
};

/// Residuals that tie blocks 0-1, 1-2, 2-4 and 3-0, and each block by itself.
void fill(std::uint64_t seed, Equations& equations) {
  simulation::Random random(seed);
  NormalEquations& H = equations.sparse;
  const std::array<std::array<int, 2>, 4> ties{{{0, 1}, {2, 1}, {2, 4}, {3, 0}}};
  for (const auto& [a, b] : ties) H.couple(a, b);
  H.couple(0, 1);  // twice
  H.finish();
  equations.few.set_zero();
  const auto derivative = [&](int block) {
    Eigen::MatrixXd J(3, H.size(block));
    for (int i = 0; i < J.size(); ++i) J.data()[i] = random.normal();
    return J;
  };
  const auto add = [&](int a, int b, const Eigen::MatrixXd& product) {
    H.add(a, b, product);
    equations.few.add(a, b, product);
    equations.dense.block(H.first(a), H.first(b), H.size(a), H.size(b)) += product;
    if (a == b) return;
    equations.dense.block(H.first(b), H.first(a), H.size(b), H.size(a)) += product.transpose();
  };
  for (const auto& [a, b] : ties) {
    const Eigen::MatrixXd J_a = derivative(a), J_b = derivative(b);
    add(a, a, J_a.transpose() * J_a);
    add(b, b, J_b.transpose() * J_b);
    add(a, b, J_a.transpose() * J_b);
  }
  for (int i = 0; i < H.num_unknowns(); ++i) {
    H.add_to_diagonal(i, 0.5);
    equations.few.add_to_diagonal(i, 0.5);
    equations.dense(i, i) += 0.5;
  }
}

TEST(NormalEquations, PredictTheWorkOfTheirFactor) {
  // Dense in any order: columns with 4, 3, 2, 1, 0 entries below the diagonal.
  NormalEquations dense({3, 2});
  dense.couple(0, 1);
  dense.finish();
  EXPECT_DOUBLE_EQ(dense.factor_work(), 16.0 + 9.0 + 4.0 + 1.0);
  NormalEquations apart({3, 2});
  apart.finish();
  EXPECT_DOUBLE_EQ(apart.factor_work(), 4.0 + 1.0 + 1.0);
}

TEST(NormalEquations, AreSolvedAndInvertedAsTheDenseOnes) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Equations equations;
    fill(seed, equations);
    NormalEquations& H = equations.sparse;
    const Eigen::MatrixXd inverse = equations.dense.inverse();
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(11, -1.0, 1.0);
    ASSERT_TRUE(H.factorise());
    EXPECT_LT((H.solve(right) - inverse * right).norm(), 1e-9);
    ASSERT_TRUE(equations.few.factorise());
    EXPECT_LT((equations.few.solve(right) - inverse * right).norm(), 1e-9);
    EXPECT_LT((equations.few.matrix() - equations.dense).norm(), 1e-12);
    const SelectedInverse P = std::move(H).inverse();
    for (int i = 0; i < 11; ++i) {
      for (int j = 0; j < 11; ++j) {
        if (equations.dense(i, j) == 0.0) continue;
        EXPECT_NEAR(P.at(i, j), inverse(i, j), 1e-9);
      }
    }
  }
}

TEST(NormalEquations, CountAnEntryOnce) {
  NormalEquations H{{3, 3}};
  for (int i = 0; i < 1000; ++i) H.couple(i % 2, 1 - i % 2);
  EXPECT_EQ(H.num_entries(), 6u + 9u + 6u);
}

TEST(NormalEquations, RefuseWhatIsNotDetermined) {
  NormalEquations H{{2, 2}};
  H.finish();
  H.add(0, 0, Eigen::Matrix2d::Identity().eval());
  EXPECT_FALSE(H.factorise());
  EXPECT_THROW(H.add(0, 1, Eigen::Matrix2d::Identity().eval()), std::logic_error);
}

}  // namespace
}  // namespace orchard::pose
