// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/position_mode.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace orchard::mapping {
namespace {

TEST(PositionMode, OfOnePointIsThePoint) {
  const PositionMode mode = position_mode({{{3.0, -4.0}, 400.0}}, {3.0, -4.0}, 0.2);
  EXPECT_NEAR(mode.p_map.x(), 3.0, 1e-12);
  EXPECT_NEAR(mode.p_map.y(), -4.0, 1e-12);
  EXPECT_DOUBLE_EQ(mode.covariance(0, 0), 1.0 / 400.0);
  EXPECT_EQ(mode.covariance(0, 1), 0.0);
}

TEST(PositionMode, WithinItsKernelIsTheWeightedMean) {
  const std::vector<WeightedPoint> points = {{{1.0, 2.0}, 100.0}, {{1.02, 2.0}, 300.0}};
  const PositionMode mode = position_mode(points, {1.01, 2.0}, 5.0);
  EXPECT_NEAR(mode.p_map.x(), 1.015, 1e-6);
  EXPECT_NEAR(mode.p_map.y(), 2.0, 1e-12);
}

TEST(PositionMode, ScatterIsTheMeanSquareDeviationByInverseVariance) {
  const Eigen::Matrix2d scatter_m2 =
      scatter_around({1.0, 2.0}, {{{1.3, 2.0}, 100.0}, {{1.0, 1.8}, 300.0}});
  EXPECT_NEAR(scatter_m2(0, 0), 0.25 * 0.09, 1e-12);
  EXPECT_NEAR(scatter_m2(1, 1), 0.75 * 0.04, 1e-12);
  EXPECT_NEAR(scatter_m2(0, 1), 0.0, 1e-12);
}

TEST(PositionMode, IsNotDrawnByAnotherThing) {
  std::vector<WeightedPoint> points;
  for (int k = -5; k <= 5; ++k) points.push_back({{0.01 * k, 0.0}, 100.0});
  const std::vector<WeightedPoint> alone = points;
  for (int k = 0; k < 4; ++k) points.push_back({{1.5, 0.5}, 100.0});
  const PositionMode mode = position_mode(points, {0.4, 0.13}, 0.2);  // from the mean of all
  const PositionMode without = position_mode(alone, {0.0, 0.0}, 0.2);
  EXPECT_LT((mode.p_map - without.p_map).norm(), 1e-6);
  EXPECT_NEAR(mode.covariance(0, 0), without.covariance(0, 0), 1e-9);
  // eleven points 1 cm apart: (2 (1 + 4 + 9 + 16 + 25) 1e-4 m2) / 10 / 11, a little less by the
  // kernel
  EXPECT_NEAR(without.covariance(0, 0), 1e-4, 2e-6);
}

/// Mean shift as its comment says, point by point, with the library's exponential.
PositionMode plain_mean_shift(const std::vector<WeightedPoint>& points, Eigen::Vector2d mode,
                              double kernel_m) {
  const auto weight_at = [&](const WeightedPoint& point, double width_m) {
    const double u2 = (point.p_map - mode).squaredNorm() / (width_m * width_m);
    return point.weight * std::exp(-0.5 * std::min(u2, 60.0));
  };
  double sum = 0.0, sum2 = 0.0;
  for (int round = 0; round < 12; ++round) {
    Eigen::Vector2d next = Eigen::Vector2d::Zero();
    sum = sum2 = 0.0;
    for (const WeightedPoint& point : points) {
      const double weight = weight_at(point, kernel_m * std::max(1.0, 4.0 - 0.5 * round));
      next += weight * point.p_map;
      sum += weight;
      sum2 += weight * weight;
    }
    mode = next / sum;
  }
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (const WeightedPoint& point : points) {
    const Eigen::Vector2d delta = point.p_map - mode;
    scatter += weight_at(point, kernel_m) * delta * delta.transpose();
  }
  scatter /= sum * std::max(1.0, std::max(1.0, sum * sum / sum2) - 1.0);
  return {mode, scatter};
}

TEST(PositionMode, IsMeanShiftToTheLastDigits) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const std::size_t size : {2, 3, 7, 40, 512}) {
    for (const double spread_m : {0.01, 0.1, 0.6}) {  // from a heap to far outside the kernel
      std::vector<WeightedPoint> points;
      for (std::size_t k = 0; k < size; ++k) {
        points.push_back({{120.0 + spread_m * normal(random), -80.0 + spread_m * normal(random)},
                          400.0 + 100.0 * std::abs(normal(random))});
      }
      const PositionMode mode = position_mode(points, {120.0, -80.0}, 0.2);
      const PositionMode plain = plain_mean_shift(points, {120.0, -80.0}, 0.2);
      EXPECT_LT((mode.p_map - plain.p_map).norm(), 1e-10);
      EXPECT_LT((mode.covariance - plain.covariance).norm(), 1e-8 * plain.covariance.norm());
    }
  }
}

/// A mode that says of how many observations it is.
PositionMode made_of(std::int32_t num_observations) {
  return {{static_cast<double>(num_observations), 0.0}, Eigen::Matrix2d::Identity()};
}

TEST(ModeCache, AFewObservationsAreAlwaysTakenAnew) {
  ModeCache cache;
  for (std::int32_t n = 1; n <= 32; ++n) {
    EXPECT_EQ(cache.at(7, n, [&] { return made_of(n); }).p_map.x(), n);
  }
}

TEST(ModeCache, IsASixteenthBehindAtMostAndNeverManyObservations) {
  ModeCache cache;
  for (std::int32_t n = 1; n <= 3000; ++n) {
    const double of = cache.at(3, n, [&] { return made_of(n); }).p_map.x();
    EXPECT_GT(of, n - 32);
    EXPECT_GT(of, n - n / 16.0);
    EXPECT_LE(of, n);
  }
}

TEST(ModeCache, CostsNoMoreTheLongerALandmarkIsKnown) {
  ModeCache cache;
  int num_made = 0;
  int until_1000 = 0;
  for (std::int32_t n = 1; n <= 11000; ++n) {
    cache.at(0, n, [&] {
      ++num_made;
      return made_of(n);
    });
    if (n == 1000) until_1000 = num_made;
  }
  EXPECT_LE(num_made - until_1000, 10000 / 32 + 1);
}

TEST(ModeCache, ForgetsWhatItIsToldToAndKnowsLandmarksApart) {
  ModeCache cache;
  cache.at(2, 100, [] { return made_of(100); });
  cache.at(5, 101, [] { return made_of(101); });
  EXPECT_EQ(cache.at(2, 102, [] { return made_of(102); }).p_map.x(), 100);
  cache.forget(2);
  EXPECT_EQ(cache.at(2, 102, [] { return made_of(102); }).p_map.x(), 102);
  EXPECT_EQ(cache.at(5, 102, [] { return made_of(102); }).p_map.x(), 101);
  cache.forget(1000);
}

}  // namespace

}  // namespace orchard::mapping
