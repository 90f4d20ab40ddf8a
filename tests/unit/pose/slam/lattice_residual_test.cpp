// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/loop_closer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::pose {
namespace {

TEST(PlantedSd, IsTheIrregularityOfRows) {
  // Each of two trees that come to lie on each other stands off its place by so much.
  constexpr double kSd_m = 0.1;
  simulation::Random random(1);
  std::vector<Eigen::Vector2d> trees;
  for (int row = 0; row < 8; ++row) {
    for (int t = 0; t < 20; ++t) {
      trees.emplace_back(2.5 * t + random.normal(0.0, kSd_m),
                         4.0 * row + random.normal(0.0, kSd_m));
    }
  }
  EXPECT_NEAR(lattice_residual_sd_m(trees), std::sqrt(2.0) * kSd_m, 0.05);
}

TEST(PlantedSd, IsWhatDensityGivesWhereTreesStandInNoOrder) {
  // The nearest of points in no order is a distance r away with the density of a Gaussian of
  // variance 1 / (2 pi n) for n points a square metre (Poisson), here over two.
  simulation::Random random(2);
  std::vector<Eigen::Vector2d> trees;
  for (int i = 0; i < 400; ++i) {
    trees.emplace_back(random.uniform(0.0, 200.0), random.uniform(0.0, 200.0));
  }
  const double expected_m = std::sqrt(0.5 / (2.0 * geometry::kPi * 0.01));
  EXPECT_NEAR(lattice_residual_sd_m(trees), expected_m, 0.25 * expected_m);
}

TEST(PlantedSd, OfAFewTreesIsUnknown) {
  EXPECT_TRUE(std::isinf(lattice_residual_sd_m({{0.0, 0.0}, {1.0, 0.0}, {2.0, 0.0}})));
}

}  // namespace
}  // namespace orchard::pose
