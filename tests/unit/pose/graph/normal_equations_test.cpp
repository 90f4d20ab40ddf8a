// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>

#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

struct Equations {
  NormalEquations sparse{{3, 2, 3, 1, 2}};
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
  const auto derivative = [&](int block) {
    Eigen::MatrixXd J(3, H.size(block));
    for (int i = 0; i < J.size(); ++i) J.data()[i] = random.normal();
    return J;
  };
  const auto add = [&](int a, int b, const Eigen::MatrixXd& product) {
    H.add(a, b, product);
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
    EXPECT_DOUBLE_EQ(H.diagonal(4), equations.dense(4, 4));
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
