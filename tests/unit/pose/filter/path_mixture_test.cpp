// SPDX-License-Identifier: BSD-3-Clause
// Truth: poses drawn from the mixture.
#include "pose/filter/path_smoother.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/angles.hpp"

namespace orchard::pose {
namespace {

PoseEstimate pose_at(double x_m, double y_m, double yaw_rad, double sd_m) {
  PoseEstimate pose;
  pose.x_m = x_m;
  pose.y_m = y_m;
  pose.yaw_rad = yaw_rad;
  pose.covariance = {sd_m * sd_m, 0.0, 0.0, sd_m * sd_m, 0.0, 1e-4};
  return pose;
}

TEST(PathMixture, OnePathStaysAsItIs) {
  const auto mean = mean_path({{0.3, {pose_at(1.0, 2.0, 3.0, 0.5)}}});
  ASSERT_EQ(mean.size(), 1U);
  EXPECT_DOUBLE_EQ(mean[0].x_m, 1.0);
  EXPECT_DOUBLE_EQ(mean[0].yaw_rad, 3.0);
  EXPECT_DOUBLE_EQ(mean[0].covariance[0], 0.25);
}

TEST(PathMixture, TheCovarianceIsThatOfDrawnPoses) {
  const PoseEstimate a = pose_at(0.0, 0.0, 0.1, 1.0), b = pose_at(8.0, -4.0, 0.3, 2.0);
  const PoseEstimate mean = mean_path({{0.6, {a}}, {0.2, {b}}})[0];  // three to one
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  double likeliest2 = 0.0;
  constexpr int kDraws = 200'000;
  for (int i = 0; i < kDraws; ++i) {
    const PoseEstimate& path = uniform(random) < 0.75 ? a : b;
    const double sd_m = std::sqrt(path.covariance[0]);
    const double x_m = path.x_m + sd_m * normal(random);
    const double y_m = path.y_m + sd_m * normal(random);
    const double yaw_rad = path.yaw_rad + 0.01 * normal(random);
    const Eigen::Vector3d d(x_m - mean.x_m, y_m - mean.y_m, yaw_rad - mean.yaw_rad);
    moments += d * d.transpose() / kDraws;
    likeliest2 += (x_m * x_m + y_m * y_m) / kDraws;
  }
  const double told[] = {moments(0, 0), moments(0, 1), moments(0, 2),
                         moments(1, 1), moments(1, 2), moments(2, 2)};
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_NEAR(mean.covariance[k], told[k], 0.02 * std::abs(told[k])) << "term " << k;
  }
  EXPECT_LT(moments(0, 0) + moments(1, 1), 0.8 * likeliest2);
}

TEST(PathMixture, ASpreadIsNotableWhereItExceedsThePathsOwn) {
  const std::vector<PoseEstimate> a{pose_at(0.0, 0.0, 0.0, 1.0), pose_at(5.0, 0.0, 0.0, 1.0)};
  const std::vector<PoseEstimate> far{pose_at(0.0, 0.0, 0.0, 1.0), pose_at(5.0, 8.0, 0.0, 1.0)};
  const std::vector<PoseEstimate> near{pose_at(0.0, 0.0, 0.0, 1.0), pose_at(5.0, 1.0, 0.0, 1.0)};
  EXPECT_DOUBLE_EQ(notable_spread_m({{0.5, a}, {0.5, far}}), 4.0);
  EXPECT_DOUBLE_EQ(notable_spread_m({{0.5, a}, {0.5, near}}), 0.0);
  EXPECT_DOUBLE_EQ(notable_spread_m({{1.0, a}}), 0.0);
}

TEST(PathMixture, HeadingsAreAveragedAcrossPi) {
  const PoseEstimate a = pose_at(0.0, 0.0, geometry::kPi - 0.1, 1.0);
  const PoseEstimate b = pose_at(0.0, 0.0, 0.2 - geometry::kPi, 1.0);
  const PoseEstimate mean = mean_path({{0.5, {a}}, {0.5, {b}}})[0];
  EXPECT_NEAR(geometry::wrap_angle_rad(mean.yaw_rad - geometry::kPi), 0.05, 1e-12);
}

}  // namespace
}  // namespace orchard::pose
