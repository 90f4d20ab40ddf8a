// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/statistics.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace orchard::geometry {
namespace {

std::vector<double> shuffled(int n, std::mt19937& random) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back(i);
  std::shuffle(values.begin(), values.end(), random);
  return values;
}

TEST(Statistics, QuantileIsTheValueOfItsRank) {
  std::mt19937 random(7);
  for (const int n : {1, 2, 3, 4, 10, 101}) {
    const std::vector<double> values = shuffled(n, random);
    EXPECT_EQ(quantile(values, 0.0), 0.0);
    EXPECT_EQ(quantile(values, 0.75), 3 * n / 4);
    EXPECT_EQ(quantile(values, 1.0), n - 1);
    EXPECT_EQ(median(values), n / 2);
  }
}

TEST(Statistics, MidpointMedianHalvesTheMiddle) {
  EXPECT_EQ(midpoint_median({4.0, 1.0, 3.0}), 3.0);
  EXPECT_EQ(midpoint_median({4.0, 1.0, 3.0, 2.0}), 2.5);
  EXPECT_EQ(midpoint_median({5.0}), 5.0);
}

TEST(Statistics, NoValuesGiveZero) {
  EXPECT_EQ(quantile({}, 0.5), 0.0);
  EXPECT_EQ(midpoint_median({}), 0.0);
  EXPECT_EQ(robust_sd({}), 0.0);
}

TEST(Statistics, RobustSdIsThatOfANormalDistributionDespiteOutliers) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0.0, 0.3);
  std::vector<double> deviations;
  for (int i = 0; i < 20000; ++i) deviations.push_back(normal(random));
  EXPECT_NEAR(robust_sd(deviations), 0.3, 0.01);
  for (int i = 0; i < 400; ++i) deviations.push_back(1e6);
  EXPECT_NEAR(robust_sd(deviations), 0.3, 0.02);
}

TEST(Statistics, GatesHoldTheStatedFractionOfTheChiSquareDistribution) {
  EXPECT_NEAR(1.0 - std::exp(-0.5 * kChiSquare2_997), 0.9973, 1e-4);
  EXPECT_NEAR(1.0 - std::exp(-0.5 * kChiSquare2_999), 0.999, 1e-4);
}

}  // namespace
}  // namespace orchard::geometry
