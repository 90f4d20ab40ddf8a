// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/thinned_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace orchard::geometry {
namespace {

using Line = std::vector<Eigen::Vector2d>;

double distance_m(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double fraction = length2 > 0.0 ? std::clamp((p - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (p - a - fraction * along).norm();
}

double distance_m(const Eigen::Vector2d& p, const Line& line) {
  double least = (p - line.front()).norm();
  for (std::size_t k = 1; k < line.size(); ++k) {
    least = std::min(least, distance_m(p, line[k - 1], line[k]));
  }
  return least;
}

/// A robot's way: straight stretches, curves, standing still, turning back.
Line drive(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 0.002);
  Line line{{0, 0}};
  double yaw_rad = 0.0, turn_rad = 0.0, step_m = 0.1;
  for (int k = 0; k < 3000; ++k) {
    if (unit(random) < 0.01) turn_rad = unit(random) < 0.5 ? 0.0 : 0.1 * (unit(random) - 0.5);
    if (unit(random) < 0.01) step_m = unit(random) < 0.2 ? 0.0 : 0.2 * unit(random) - 0.05;
    yaw_rad += turn_rad;
    const Eigen::Vector2d step(step_m * std::cos(yaw_rad), step_m * std::sin(yaw_rad));
    line.push_back(line.back() + step + Eigen::Vector2d(noise(random), noise(random)));
  }
  return line;
}

TEST(LineThinning, LeavesOutOnlyWhatLiesOnTheLine) {
  constexpr double kTolerance_m = 0.02;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Line line = drive(seed);
    const Line thin = thinned_line(line, kTolerance_m);
    EXPECT_EQ(thin.front(), line.front());
    EXPECT_EQ(thin.back(), line.back());
    EXPECT_LT(thin.size(), line.size() / 2) << "seed " << seed;
    double worst_m = 0.0;
    for (const Eigen::Vector2d& p : line) worst_m = std::max(worst_m, distance_m(p, thin));
    EXPECT_LE(worst_m, 2.0 * kTolerance_m) << "seed " << seed;
  }
}

TEST(LineThinning, AStraightLineIsItsTwoEnds) {
  Line line;
  for (int k = 0; k <= 100; ++k) line.emplace_back(0.3 * k, 0.1 * k);
  EXPECT_EQ(thinned_line(line, 0.01).size(), 2u);
}

TEST(LineThinning, AWayBackKeepsItsFarthestPoint) {
  Line line;
  for (int k = 0; k <= 50; ++k) line.emplace_back(0.1 * k, 0.0);
  for (int k = 50; k >= 0; --k) line.emplace_back(0.1 * k, 0.0);
  const Line thin = thinned_line(line, 0.01);
  double farthest_m = 0.0;
  for (const Eigen::Vector2d& p : thin) farthest_m = std::max(farthest_m, p.x());
  EXPECT_NEAR(farthest_m, 5.0, 0.11);
}

TEST(LineThinning, ShortLinesStayAsTheyAre) {
  EXPECT_TRUE(thinned_line({}, 0.01).empty());
  EXPECT_EQ(thinned_line({{1, 2}}, 0.01).size(), 1u);
  EXPECT_EQ(thinned_line({{1, 2}, {1, 2}}, 0.01).size(), 2u);
}

}  // namespace
}  // namespace orchard::geometry
