// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/normal_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

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
    const auto P = selected_inverse(H);
    ASSERT_TRUE(P);
    const Eigen::MatrixXd dense = Eigen::MatrixXd(H).inverse();
    for (int j = 0; j < H.outerSize(); ++j) {
      for (Eigen::SparseMatrix<double>::InnerIterator it(H, j); it; ++it) {
        EXPECT_NEAR(P->at(it.row(), it.col()), dense(it.row(), it.col()), 1e-9);
      }
    }
  }
}

TEST(SelectedInverse, RefusesWhatIsNotPositiveDefinite) {
  Eigen::SparseMatrix<double> H = random_information(1, 10);
  H.coeffRef(3, 3) = -1.0;
  EXPECT_FALSE(selected_inverse(H));
}

}  // namespace
}  // namespace orchard::pose
