// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/pose_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace orchard::pose {
namespace {

constexpr double kPi = 3.14159265358979323846;

PoseConfig config_of(PoseMode mode) {
  PoseConfig config;
  config.mode = mode;
  return config;
}

Odometry odometry(std::int64_t utime, double speed_mps, double yaw_rate_radps) {
  Odometry o;
  o.utime = utime;
  o.speed_mps = speed_mps;
  o.yaw_rate_radps = yaw_rate_radps;
  return o;
}

PoseFix fix(std::int64_t utime, double x_m, double y_m, double yaw_rad) {
  PoseFix f;
  f.utime = utime;
  f.x_m = x_m;
  f.y_m = y_m;
  f.yaw_rad = yaw_rad;
  f.covariance = {1e-4, 0, 0, 1e-4, 0, 1e-4};
  return f;
}

TEST(PoseEstimator, FixesAloneAreThePoses) {
  PoseEstimator estimator(config_of(PoseMode::kFixes));
  EXPECT_FALSE(estimator.estimate());
  estimator.add(fix(100, 1.0, 2.0, 4.0));
  const auto pose = estimator.estimate();
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->utime, 100);
  EXPECT_DOUBLE_EQ(pose->x_m, 1.0);
  EXPECT_NEAR(pose->yaw_rad, 4.0 - 2.0 * kPi, 1e-15);
  EXPECT_DOUBLE_EQ(pose->covariance[0], 1e-4);
}

// A full circle of 2 m radius at constant speed ends where it began.
TEST(PoseEstimator, DeadReckonsACircle) {
  PoseEstimator estimator(config_of(PoseMode::kOdometry));
  const double speed_mps = 1.0, yaw_rate_radps = 0.5;
  const int steps = 1000;
  const double duration_s = 2.0 * kPi / yaw_rate_radps;
  for (int i = 0; i <= steps; ++i) {
    estimator.add(odometry(std::llround(1e6 * duration_s * i / steps), speed_mps, yaw_rate_radps));
    if (i == steps / 2) {
      EXPECT_NEAR(estimator.estimate()->x_m, 0.0, 1e-5);
      EXPECT_NEAR(estimator.estimate()->y_m, 4.0, 1e-5);
    }
  }
  EXPECT_NEAR(estimator.estimate()->x_m, 0.0, 1e-5);
  EXPECT_NEAR(estimator.estimate()->y_m, 0.0, 1e-5);
  EXPECT_NEAR(estimator.estimate()->yaw_rad, 0.0, 1e-5);
}

// The stated covariance of dead reckoning against the scatter of many noisy drives.
TEST(PoseEstimator, CovarianceOfDeadReckoningIsThatOfManyDrives) {
  const double sd_speed = 0.1, sd_yaw_rate = 0.05;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_of_squares = Eigen::Matrix3d::Zero();
  std::array<double, 6> stated{};
  const int drives = 4000;
  for (int drive = 0; drive < drives; ++drive) {
    PoseEstimator estimator(config_of(PoseMode::kOdometry));
    for (int i = 0; i <= 40; ++i) {
      // Velocity is averaged between messages, so that an interval's noise is of half the variance
      // and neighbours are correlated: over many intervals the sum's variance is as stated.
      Odometry o =
          odometry(i * 100000, 1.0 + sd_speed * normal(random), 0.2 + sd_yaw_rate * normal(random));
      o.covariance = {sd_speed * sd_speed, 0.0, sd_yaw_rate * sd_yaw_rate};
      estimator.add(o);
    }
    const PoseEstimate pose = *estimator.estimate();
    const Eigen::Vector3d p(pose.x_m, pose.y_m, pose.yaw_rad);
    sum += p;
    sum_of_squares += p * p.transpose();
    stated = pose.covariance;
  }
  const Eigen::Vector3d mean = sum / drives;
  const Eigen::Matrix3d scatter = sum_of_squares / drives - mean * mean.transpose();
  EXPECT_NEAR(std::sqrt(stated[0]) / std::sqrt(scatter(0, 0)), 1.0, 0.15);
  EXPECT_NEAR(std::sqrt(stated[3]) / std::sqrt(scatter(1, 1)), 1.0, 0.15);
  EXPECT_NEAR(std::sqrt(stated[5]) / std::sqrt(scatter(2, 2)), 1.0, 0.15);
}

// Two measurements of equal weight meet halfway: the filter against the textbook's mean.
TEST(PoseEstimator, AFixIsWeighedAgainstDeadReckoning) {
  PoseEstimator estimator(config_of(PoseMode::kFixesAndOdometry));
  Odometry standing = odometry(0, 0.0, 0.0);
  standing.covariance = {1e-18, 0, 1e-18};
  estimator.add(standing);
  estimator.add(fix(0, 0.0, 0.0, 0.0));
  standing.utime = 100000;
  estimator.add(standing);
  estimator.add(fix(100000, 0.02, 0.0, 0.0));
  EXPECT_NEAR(estimator.estimate()->x_m, 0.01, 1e-9);
  EXPECT_NEAR(estimator.estimate()->covariance[0], 0.5e-4, 1e-9);
}

TEST(PoseEstimator, FixesWithoutYawGiveAPoseOnceTheRobotHasTravelled) {
  PoseEstimator estimator(config_of(PoseMode::kFixes));
  PoseFix f = fix(0, 0.0, 0.0, 0.0);
  f.has_yaw = false;
  estimator.add(f);
  EXPECT_FALSE(estimator.estimate());
  f.utime = 1000000;
  f.x_m = 0.0;
  f.y_m = 0.6;
  estimator.add(f);
  ASSERT_TRUE(estimator.estimate());
  EXPECT_NEAR(estimator.estimate()->yaw_rad, kPi / 2.0, 1e-12);
}

TEST(PoseEstimator, ALongSilenceForgetsThePoseUntilTheNextFix) {
  PoseEstimator estimator(config_of(PoseMode::kFixesAndOdometry));
  estimator.add(odometry(0, 1.0, 0.0));
  estimator.add(fix(0, 0.0, 0.0, 0.0));
  estimator.add(odometry(5000000, 1.0, 0.0));
  EXPECT_FALSE(estimator.estimate());
  EXPECT_EQ(estimator.num_gaps(), 1);
  estimator.add(fix(5100000, 5.0, 0.0, 0.0));
  ASSERT_TRUE(estimator.estimate());
  EXPECT_DOUBLE_EQ(estimator.estimate()->x_m, 5.0);
}

// On a circle of 2 m radius, whose centre is at (0, 2), the first fix comes after a quarter of it.
TEST(PoseEstimator, TheFirstFixTellsTheWayThatLedToIt) {
  PoseEstimator estimator(config_of(PoseMode::kFixesAndOdometry));
  const double yaw_rate_radps = 0.5;
  const std::int64_t period_us = 20'000;
  const auto num = static_cast<int>(std::llround(0.5 * kPi / yaw_rate_radps / 0.02));
  for (int i = 0; i <= num; ++i) estimator.add(odometry(i * period_us, 1.0, yaw_rate_radps));
  EXPECT_FALSE(estimator.estimate());
  EXPECT_TRUE(estimator.take_past_poses().empty());
  const double last_rad = yaw_rate_radps * 0.02 * num;
  estimator.add(
      fix(num * period_us, 2.0 * std::sin(last_rad), 2.0 - 2.0 * std::cos(last_rad), last_rad));
  const std::vector<PoseEstimate> past = estimator.take_past_poses();
  ASSERT_EQ(past.size(), static_cast<std::size_t>(num));
  for (int i = 0; i < num; ++i) {
    const PoseEstimate& pose = past[static_cast<std::size_t>(i)];
    const double turned_rad = yaw_rate_radps * 0.02 * i;
    EXPECT_EQ(pose.utime, i * period_us);
    EXPECT_NEAR(pose.x_m, 2.0 * std::sin(turned_rad), 1e-9);
    EXPECT_NEAR(pose.y_m, 2.0 - 2.0 * std::cos(turned_rad), 1e-9);
    EXPECT_NEAR(pose.yaw_rad, turned_rad, 1e-9);
  }
  EXPECT_GT(past.front().covariance[0], past.back().covariance[0]) << "the farther, the less sure";
  EXPECT_TRUE(estimator.take_past_poses().empty()) << "once";
}

TEST(PoseEstimator, TheWayBackEndsAtASilence) {
  PoseEstimator estimator(config_of(PoseMode::kFixesAndOdometry));
  estimator.add(odometry(0, 1.0, 0.0));
  estimator.add(odometry(100'000'000, 1.0, 0.0));
  estimator.add(odometry(100'100'000, 1.0, 0.0));
  estimator.add(fix(100'100'000, 1.0, 0.0, 0.0));
  const std::vector<PoseEstimate> past = estimator.take_past_poses();
  ASSERT_EQ(past.size(), 1u);
  EXPECT_EQ(past[0].utime, 100'000'000);
  EXPECT_NEAR(past[0].x_m, 0.9, 1e-9);
}

}  // namespace
}  // namespace orchard::pose
