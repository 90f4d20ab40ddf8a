// SPDX-License-Identifier: BSD-3-Clause
#include "pose/localiser.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

#include "pose/pose_estimate.hpp"
#include "pose/repeat_model.hpp"
#include "timing/drive_time.hpp"

namespace orchard::pose {
namespace {

// Modes `fixes`, `odometry` and `fixes_and_odometry`.

constexpr double kPi = 3.14159265358979323846;

std::unique_ptr<Localiser> localiser_of(PoseMode mode) {
  PoseConfig config;
  config.mode = mode;
  return make_localiser(config);
}

Measurement odometry(std::int64_t utime, double speed_mps, double yaw_rate_radps,
                     const std::array<double, 3>& covariance = {}) {
  Odometry o;
  o.utime = utime;
  o.speed_mps = speed_mps;
  o.yaw_rate_radps = yaw_rate_radps;
  o.covariance = covariance;
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

TEST(ModeFixes, TheFixesAreThePoses) {
  const auto localiser = localiser_of(PoseMode::kFixes);
  EXPECT_FALSE(localiser->estimate());
  localiser->add(fix(100, 1.0, 2.0, 4.0));
  const auto pose = localiser->estimate();
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->utime, 100);
  EXPECT_DOUBLE_EQ(pose->x_m, 1.0);
  EXPECT_NEAR(pose->yaw_rad, 4.0 - 2.0 * kPi, 1e-15);
  EXPECT_DOUBLE_EQ(pose->covariance[0], 1e-4);
}

TEST(ModeFixes, WhatAFixDoesNotStateIsAsConfigured) {
  const auto localiser = localiser_of(PoseMode::kFixes);
  PoseFix f = fix(100, 1.0, 2.0, 0.0);
  f.covariance = {};
  localiser->add(f);
  const PoseConfig config;
  const auto c = localiser->estimate()->covariance;
  EXPECT_DOUBLE_EQ(c[0], config.fix_position_sd_m * config.fix_position_sd_m);
  EXPECT_DOUBLE_EQ(c[3], config.fix_position_sd_m * config.fix_position_sd_m);
  EXPECT_DOUBLE_EQ(c[5], config.fix_yaw_sd_rad * config.fix_yaw_sd_rad);
}

TEST(ModeFixes, WithoutYawTheyPointAlongTheWay) {
  const auto localiser = localiser_of(PoseMode::kFixes);
  PoseFix f = fix(0, 0.0, 0.0, 0.0);
  f.has_yaw = false;
  localiser->add(f);
  EXPECT_FALSE(localiser->estimate());
  f.utime = 1000000;
  f.y_m = 0.6;
  localiser->add(f);
  ASSERT_TRUE(localiser->estimate());
  EXPECT_NEAR(localiser->estimate()->yaw_rad, kPi / 2.0, 1e-12);
  EXPECT_NEAR(localiser->estimate()->covariance[5], 2e-4 / 0.36, 1e-12);
  f.utime = 2000000;
  f.x_m = 0.1;  // too short a way for another heading
  localiser->add(f);
  EXPECT_DOUBLE_EQ(localiser->estimate()->x_m, 0.1);
  EXPECT_NEAR(localiser->estimate()->yaw_rad, kPi / 2.0, 1e-12);
}

// A full circle of 2 m radius at constant speed ends where it began.
TEST(ModeOdometry, ReckonsACircle) {
  const auto localiser = localiser_of(PoseMode::kOdometry);
  const double speed_mps = 1.0, yaw_rate_radps = 0.5;
  const int steps = 1000;
  const double duration_s = 2.0 * kPi / yaw_rate_radps;
  for (int i = 0; i <= steps; ++i) {
    localiser->add(odometry(std::llround(1e6 * duration_s * i / steps), speed_mps, yaw_rate_radps));
    if (i == steps / 2) {
      EXPECT_NEAR(localiser->estimate()->x_m, 0.0, 1e-5);
      EXPECT_NEAR(localiser->estimate()->y_m, 4.0, 1e-5);
    }
  }
  EXPECT_NEAR(localiser->estimate()->x_m, 0.0, 1e-5);
  EXPECT_NEAR(localiser->estimate()->y_m, 0.0, 1e-5);
  EXPECT_NEAR(localiser->estimate()->yaw_rad, 0.0, 1e-5);
}

// The stated covariance against the scatter of many noisy drives.
TEST(ModeOdometry, StatesTheScatterOfManyDrives) {
  const double sd_speed_mps = 0.1, sd_yaw_rate_radps = 0.05;
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d sum_of_squares = Eigen::Matrix3d::Zero();
  std::array<double, 6> stated{};
  const int drives = 4000;
  for (int drive = 0; drive < drives; ++drive) {
    const auto localiser = localiser_of(PoseMode::kOdometry);
    for (int i = 0; i <= 40; ++i) {
      const double speed_mps = 1.0 + sd_speed_mps * normal(random);
      localiser->add(
          odometry(i * 100000, speed_mps, 0.2 + sd_yaw_rate_radps * normal(random),
                   {sd_speed_mps * sd_speed_mps, 0.0, sd_yaw_rate_radps * sd_yaw_rate_radps}));
    }
    const PoseEstimate pose = *localiser->estimate();
    const Eigen::Vector3d p(pose.x_m, pose.y_m, pose.yaw_rad);
    sum += p;
    sum_of_squares += p * p.transpose();
    stated = pose.covariance;
  }
  const Eigen::Vector3d mean = sum / drives;
  const Eigen::Matrix3d scatter = sum_of_squares / drives - mean * mean.transpose();
  EXPECT_NEAR(std::sqrt(stated[0]) / std::sqrt(scatter(0, 0)), 1.0, 0.05);
  EXPECT_NEAR(std::sqrt(stated[3]) / std::sqrt(scatter(1, 1)), 1.0, 0.05);
  EXPECT_NEAR(std::sqrt(stated[5]) / std::sqrt(scatter(2, 2)), 1.0, 0.05);
}

TEST(ModeOdometry, ASilenceIsTakenForARest) {
  const auto localiser = localiser_of(PoseMode::kOdometry);
  localiser->add(odometry(0, 1.0, 0.0));
  localiser->add(odometry(100'000, 1.0, 0.0));
  localiser->add(odometry(5'100'000, 1.0, 0.0));
  ASSERT_TRUE(localiser->estimate());
  EXPECT_NEAR(localiser->estimate()->x_m, 0.1, 1e-9);
  EXPECT_GT(localiser->estimate()->covariance[0], 1.0);
}

// Two measurements of equal weight meet halfway: the filter against the textbook's mean.
TEST(ModeFixesAndOdometry, AFixIsWeighedAgainstTheWheels) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  const std::array<double, 3> known{1e-18, 0, 1e-18};
  localiser->add(odometry(0, 0.0, 0.0, known));
  localiser->add(fix(0, 0.0, 0.0, 0.0));
  localiser->add(odometry(100000, 0.0, 0.0, known));
  localiser->add(fix(100000, 0.02, 0.0, 0.0));
  EXPECT_NEAR(localiser->estimate()->x_m, 0.01, 1e-9);
  EXPECT_NEAR(localiser->estimate()->covariance[0], 0.5e-4, 1e-6);
}

TEST(ModeFixesAndOdometry, TheScaleOfTheWheelsIsLearnt) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  for (int i = 0; i <= 400; ++i) {
    const std::int64_t utime = i * 100'000;
    localiser->add(odometry(utime, 1.04, 0.0));
    if (i <= 300 && i % 10 == 0) localiser->add(fix(utime, 0.1 * i, 0.0, 0.0));
  }
  // Ten metres on wheels that tell 0.4 m too much.
  EXPECT_NEAR(localiser->estimate()->x_m, 40.0, 0.05);
}

TEST(ModeFixesAndOdometry, AfterASilenceTheNextFixCounts) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  localiser->add(odometry(0, 1.0, 0.0));
  localiser->add(fix(0, 0.0, 0.0, 0.0));
  localiser->add(odometry(5000000, 1.0, 0.0));
  EXPECT_GT(localiser->estimate()->covariance[0], 1.0);
  localiser->add(fix(5100000, 5.0, 0.0, 0.0));
  EXPECT_NEAR(localiser->estimate()->x_m, 5.0, 1e-3);
}

TEST(ModeFixesAndOdometry, WithoutWheelsTheFixesAreThePoses) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  for (int i = 0; i < 5; ++i) {
    localiser->add(fix(i * 1'000'000, 3.0 * i, 1.0, 0.5));
    ASSERT_TRUE(localiser->estimate());
    EXPECT_EQ(localiser->estimate()->utime, i * 1'000'000);
    EXPECT_DOUBLE_EQ(localiser->estimate()->x_m, 3.0 * i);
  }
}

// On a circle of 2 m radius, whose centre is at (0, 2), the first fix comes after a quarter of it.
TEST(ModeFixesAndOdometry, TheFirstFixTellsTheWayThatLedToIt) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  const double yaw_rate_radps = 0.5;
  const std::int64_t period_us = 20'000;
  const auto num = static_cast<int>(std::llround(0.5 * kPi / yaw_rate_radps / 0.02));
  for (int i = 0; i <= num; ++i) localiser->add(odometry(i * period_us, 1.0, yaw_rate_radps));
  EXPECT_FALSE(localiser->estimate());
  EXPECT_TRUE(localiser->take_past_poses().empty());
  const double last_rad = yaw_rate_radps * 0.02 * num;
  localiser->add(
      fix(num * period_us, 2.0 * std::sin(last_rad), 2.0 - 2.0 * std::cos(last_rad), last_rad));
  const std::vector<PoseEstimate> past = localiser->take_past_poses();
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
  EXPECT_TRUE(localiser->take_past_poses().empty()) << "once";
}

TEST(ModeFixesAndOdometry, TheWayBackEndsAtASilence) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  localiser->add(odometry(0, 1.0, 0.0));
  localiser->add(odometry(100'000'000, 1.0, 0.0));
  localiser->add(odometry(100'100'000, 1.0, 0.0));
  localiser->add(fix(100'100'000, 1.0, 0.0, 0.0));
  const std::vector<PoseEstimate> past = localiser->take_past_poses();
  ASSERT_EQ(past.size(), 1u);
  EXPECT_EQ(past[0].utime, 100'000'000);
  EXPECT_NEAR(past[0].x_m, 0.9, 1e-9);
}

TEST(ModeFixesAndOdometry, TheWayBackIsAMinuteAtMost) {
  const auto localiser = localiser_of(PoseMode::kFixesAndOdometry);
  for (int i = 0; i <= 700; ++i) localiser->add(odometry(i * 100'000, 1.0, 0.0));
  localiser->add(fix(70'000'000, 70.0, 0.0, 0.0));
  const std::vector<PoseEstimate> past = localiser->take_past_poses();
  ASSERT_EQ(past.size(), 601u);
  EXPECT_EQ(past[0].utime, 9'900'000);
}

Trajectory trajectory_of(std::int32_t revision, int num_poses) {
  Trajectory trajectory;
  trajectory.utime = 1000;
  trajectory.revision = revision;
  for (int i = 0; i < num_poses; ++i) {
    PoseEstimate pose;
    pose.utime = 10 * i;
    pose.x_m = 0.5 * i;
    trajectory.poses.push_back(pose);
  }
  return trajectory;
}

TEST(Trajectory, PagesComeTogetherAgainWhateverTheNumberOfPoses) {
  for (const int num_poses : {0, 1, 6, 7, 8, 13, 14, 15}) {
    const auto pages = paginate(trajectory_of(3, num_poses), 7);
    EXPECT_EQ(pages.size(), static_cast<std::size_t>(num_poses <= 7 ? 1 : num_poses <= 14 ? 2 : 3));
    TrajectoryCollector collector;
    std::optional<Trajectory> whole;
    for (const TrajectoryPage& page : pages) {
      EXPECT_FALSE(whole);
      EXPECT_LE(page.poses.size(), 7u);
      whole = collector.add(page);
    }
    ASSERT_TRUE(whole);
    EXPECT_EQ(whole->revision, 3);
    EXPECT_EQ(whole->utime, 1000);
    ASSERT_EQ(whole->poses.size(), static_cast<std::size_t>(num_poses));
    for (int i = 0; i < num_poses; ++i) {
      EXPECT_EQ(whole->poses[static_cast<std::size_t>(i)].x_m, 0.5 * i);
    }
    EXPECT_EQ(collector.num_incomplete(), 0);
  }
}

TEST(Trajectory, ARevisionThatLostAPageIsDroppedAndTheNextOneTaken) {
  for (const std::size_t lost : {0u, 1u, 2u}) {
    TrajectoryCollector collector;
    const auto pages = paginate(trajectory_of(1, 20), 7);
    for (std::size_t i = 0; i < pages.size(); ++i) {
      if (i == lost) continue;
      EXPECT_FALSE(collector.add(pages[i]));
    }
    std::optional<Trajectory> whole;
    for (const TrajectoryPage& page : paginate(trajectory_of(2, 20), 7)) {
      whole = collector.add(page);
    }
    ASSERT_TRUE(whole) << "lost page " << lost;
    EXPECT_EQ(whole->revision, 2);
    EXPECT_EQ(whole->poses.size(), 20u);
    EXPECT_EQ(collector.num_incomplete(), 1) << "lost page " << lost;
  }
}

TEST(Trajectory, WhereItsTimesFallAClockWasSetBack) {
  // Fourteen poses, one after each ten; the clock is set back by 65 before the eighth, and a
  // process that was not there before knows one epoch only.
  for (const std::int64_t epoch : {1, 0}) {
    auto pages = paginate(trajectory_of(1, 14), 7);
    for (PoseEstimate& pose : pages[1].poses) pose.utime -= 65;
    for (TrajectoryPage& page : pages) {
      page.utime = timing::kEpoch_us * epoch + 70;
      for (PoseEstimate& pose : page.poses) pose.utime += timing::kEpoch_us * epoch;
    }
    TrajectoryCollector collector;
    EXPECT_FALSE(collector.add(pages[0]));
    const auto whole = collector.add(pages[1]);
    ASSERT_TRUE(whole);
    ASSERT_EQ(whole->poses.size(), epoch == 1 ? 14u : 7u);
    for (std::size_t i = 0; i < whole->poses.size(); ++i) {
      const PoseEstimate& pose = whole->poses[whole->poses.size() - 1 - i];
      const auto utime = 10 * (13 - static_cast<std::int64_t>(i));
      EXPECT_EQ(pose.utime, i < 7 ? timing::kEpoch_us * epoch + utime - 65 : utime);
    }
    EXPECT_EQ(collector.num_incomplete(), 0);
  }
}

TEST(RepeatModel, OfARateOfOneHalfAnyRateOfAnotherVisitIsAlike) {
  // Beta(1, 1) is the uniform distribution
  for (const double rate_min : {0.05, 0.1, 0.5, 0.9}) {
    EXPECT_NEAR(probability_seen_again(0.5, rate_min), 1.0 - rate_min, 1e-12);
  }
}

TEST(RepeatModel, IsTheBetaDistributionByItsIntegral) {
  // the density integrated by substitution: t = x^a takes the pole at 0 away
  const double rate = 0.3, rate_min = 0.12;
  const double a = 2.0 * rate, b = 2.0 * (1.0 - rate);
  const auto integral_to = [&](double end) {
    const int n = 200000;
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
      const double t = std::pow(end, a) * (i + 0.5) / n;
      sum += std::pow(1.0 - std::pow(t, 1.0 / a), b - 1.0);
    }
    return sum * std::pow(end, a) / n / a;
  };
  // B(a, b) by the gamma function
  const double all = std::exp(std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b));
  EXPECT_NEAR(probability_seen_again(rate, rate_min), 1.0 - integral_to(rate_min) / all, 1e-6);
}

TEST(RepeatModel, WhatIsSeenMostlyIsSeenAgainAndATwigIsNot) {
  EXPECT_GT(probability_seen_again(detection_rate(58, 60), 0.1), 0.99);
  EXPECT_LT(probability_seen_again(detection_rate(5, 60), 0.1), 0.35);
  double before = 0.0;
  for (int seen = 0; seen <= 60; ++seen) {
    const double again = probability_seen_again(detection_rate(seen, 60), 0.1);
    EXPECT_GT(again, before);
    before = again;
  }
}

TEST(RepeatModel, ItsEndsAreProbabilities) {
  EXPECT_EQ(probability_seen_again(1.0, 0.9), 1.0);
  EXPECT_EQ(probability_seen_again(0.0, 0.1), 0.0);
  EXPECT_EQ(probability_seen_again(0.4, 0.0), 1.0);
  EXPECT_EQ(probability_seen_again(0.4, 1.0), 0.0);
  for (const double rate : {1e-9, 1e-3, 0.999, 1.0 - 1e-9}) {
    const double p = probability_seen_again(rate, 0.1);
    EXPECT_GE(p, 0.0);
    EXPECT_LE(p, 1.0);
  }
  EXPECT_EQ(detection_rate(0, 0), 0.5);
  EXPECT_LT(detection_rate(1000, 10), 1.0);
}

TEST(RepeatModel, OfAClumpAnotherVisitShowsOnePart) {
  EXPECT_EQ(probability_same_part(0), 1.0);
  EXPECT_EQ(probability_same_part(3), 0.25);
  EXPECT_LE(clump_reach_m(10.0), 1.0);
  EXPECT_LT(clump_reach_m(0.9), 0.9);  // trees of a dense planting are no clump
}

}  // namespace
}  // namespace orchard::pose
