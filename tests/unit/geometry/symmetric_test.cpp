// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/symmetric.hpp"

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <cmath>
#include <random>

namespace orchard::geometry {
namespace {

TEST(Symmetric, TheSolutionSatisfiesItsEquations) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return normal(random); });
    const Eigen::Matrix3d A = root * root.transpose() + 0.1 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d truth(normal(random), normal(random), normal(random));
    EXPECT_LT((solve_symmetric(A, A * truth) - truth).norm(), 1e-10);
    EXPECT_LT((solve_symmetric(-A, A * truth) + truth).norm(), 1e-10);
  }
}

TEST(Symmetric, AxesAreThoseTheMatrixWasMadeOf) {
  for (double angle_rad = -1.5; angle_rad < 1.5; angle_rad += 0.1) {
    const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
    const Eigen::Vector2d across(-along.y(), along.x());
    const Axes2 axes = axes_of(0.5 * across * across.transpose() + 4.0 * along * along.transpose());
    EXPECT_NEAR(axes.values(0), 0.5, 1e-12);
    EXPECT_NEAR(axes.values(1), 4.0, 1e-12);
    EXPECT_NEAR(std::abs(axes.directions.col(0).dot(across)), 1.0, 1e-12);
    EXPECT_NEAR(std::abs(axes.directions.col(1).dot(along)), 1.0, 1e-12);
  }
}

}  // namespace
}  // namespace orchard::geometry
