// SPDX-License-Identifier: BSD-3-Clause
#include "pose/filter/path_smoother.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/angles.hpp"
#include "pose/motion.hpp"

namespace orchard::pose {
namespace {

// Truth: poses drawn from the mixture.

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

// Truth: a wide circle at 2 m/s; wheels whose yaw rate is off by a constant, fixes of 2 cm but for
// a gap.

constexpr double kSpeed_mps = 2.0;
constexpr double kYawRate_radps = 0.02;

Eigen::Vector3d truth_at(double time_s) { return arc_motion(kSpeed_mps, kYawRate_radps, time_s); }

TEST(PathSmoother, AGapIsFilledFromBothItsEnds) {
  constexpr double kFrom_s = 100.0, kTo_s = 220.0, kEnd_s = 300.0;
  PathSmoother smoother{PoseConfig{}};
  smoother.place(Eigen::Vector3d::Zero());
  for (int i = 0; i <= static_cast<int>(kEnd_s * 20.0); ++i) {
    const double time_s = i / 20.0;
    const bool in_gap = time_s > kFrom_s && time_s < kTo_s;
    Eigen::Vector3d guess = truth_at(time_s);
    // What a filter without fixes makes of the wrong turn rate: far off at the gap's end.
    const double since_s = time_s - kFrom_s;
    if (in_gap) guess.y() += 0.5 * 0.008 * kSpeed_mps * since_s * since_s;
    Odometry odometry;
    odometry.utime = static_cast<std::int64_t>(1e6 * time_s);
    odometry.speed_mps = kSpeed_mps;
    odometry.yaw_rate_radps = kYawRate_radps + 0.008;
    smoother.add(odometry, guess);
    if (!in_gap && i % 4 == 0) {
      AbsolutePosition position;
      position.p_map = truth_at(time_s).head<2>();
      position.covariance = 1e-2 * Eigen::Matrix2d::Identity();
      position.is_gnss = true;
      smoother.add(odometry.utime, position, guess);
    }
    smoother.observe({});
  }
  ASSERT_TRUE(smoother.take_correction());  // at the gap's end at the latest
  smoother.finish({DisplacementHistory{}});
  const auto trajectory = smoother.take_correction();
  ASSERT_TRUE(trajectory);
  EXPECT_FALSE(smoother.take_correction());
  ASSERT_GT(trajectory->poses.size(), 100u);
  for (const PoseEstimate& pose : trajectory->poses) {
    const Eigen::Vector3d truth = truth_at(1e-6 * static_cast<double>(pose.utime));
    EXPECT_LT(std::hypot(pose.x_m - truth.x(), pose.y_m - truth.y()),
              0.01 * (kTo_s - kFrom_s) * kSpeed_mps);
    EXPECT_LT(std::abs(geometry::wrap_angle_rad(pose.yaw_rad - truth.z())), 0.05);
  }
  EXPECT_EQ(smoother.left_out().num_left_out, 0);
}

/// Drives the circle and is told poses that leap aside where fixes do, for the last five seconds of
/// every so many.
Trajectory path_with_leaps(PathSmoother& smoother, double leap_m, int every_s,
                           const DisplacementHistory& history) {
  smoother.place(Eigen::Vector3d::Zero());
  for (int i = 0; i <= 200 * 20; ++i) {
    const double time_s = i / 20.0;
    const bool is_wrong = i / 20 % every_s >= every_s - 5;
    Eigen::Vector3d told = truth_at(time_s);
    if (is_wrong) told.y() += leap_m;
    Odometry odometry;
    odometry.utime = static_cast<std::int64_t>(1e6 * time_s);
    odometry.speed_mps = kSpeed_mps;
    odometry.yaw_rate_radps = kYawRate_radps;
    smoother.add(odometry, told);
    if (i % 4 == 0) {
      AbsolutePosition position;
      position.p_map = told.head<2>();
      position.covariance = 1e-2 * Eigen::Matrix2d::Identity();
      position.is_gnss = true;
      smoother.add(odometry.utime, position, told);
    }
    smoother.tell(odometry.utime, told);
  }
  smoother.finish({history});
  return smoother.take_correction().value_or(Trajectory{});
}

TEST(PathSmoother, BothSidesOfALeapAreKeyPoses) {
  DisplacementHistory history;
  for (const std::int64_t s : {45, 95, 145, 195}) {
    history.displaced.push_back({s * 1'000'000, s * 1'000'000 + 4'999'999, true});
  }
  PathSmoother smoother{PoseConfig{}};
  const Trajectory trajectory = path_with_leaps(smoother, 98.0, 50, history);
  EXPECT_FALSE(smoother.is_doubtful());
  for (const std::int64_t leap_s : {45, 50, 95, 100, 145}) {
    for (const std::int64_t utime : {leap_s * 1'000'000 - 50'000, leap_s * 1'000'000}) {
      const auto key = std::find_if(trajectory.poses.begin(), trajectory.poses.end(),
                                    [&](const PoseEstimate& p) { return p.utime == utime; });
      ASSERT_NE(key, trajectory.poses.end()) << utime;
      const Eigen::Vector3d truth = truth_at(1e-6 * static_cast<double>(utime));
      EXPECT_LT(std::hypot(key->x_m - truth.x(), key->y_m - truth.y()), 0.5);
    }
  }
}

/// A quarter of the fixes contradicts the others, so that no path bears most of them out: still the
/// path is not the poses told, with all their leaps.
TEST(PathSmoother, APathThatTheFixesContradictIsToldAndDoubted) {
  PathSmoother smoother{PoseConfig{}};
  const Trajectory trajectory = path_with_leaps(smoother, 8.0, 20, {});
  EXPECT_TRUE(smoother.is_doubtful());
  ASSERT_FALSE(trajectory.poses.empty());
  EXPECT_EQ(trajectory.poses.back().utime, 200'000'000);
}

/// Fixes at the end say two things, 8 m apart, each for 20 s; the wheels are too bad to tell.
TEST(PathSmoother, OfTwoHistoriesThePathIsTheMean) {
  constexpr double kFrom_s = 100.0, kTo_s = 220.0, kTurn_s = 240.0, kEnd_s = 260.0;
  const Eigen::Vector2d off_m(8.0, 0.0);
  const auto end_of = [&](const std::vector<DisplacementHistory>& histories) {
    PathSmoother smoother{PoseConfig{}};
    smoother.place(Eigen::Vector3d::Zero());
    for (int i = 0; i <= static_cast<int>(kEnd_s * 20.0); ++i) {
      const double time_s = i / 20.0;
      Odometry odometry;
      odometry.utime = static_cast<std::int64_t>(1e6 * time_s);
      odometry.speed_mps = kSpeed_mps;
      odometry.yaw_rate_radps = kYawRate_radps;
      smoother.add(odometry, truth_at(time_s));
      if ((time_s > kFrom_s && time_s < kTo_s) || i % 4 != 0) continue;
      AbsolutePosition position;
      position.p_map = truth_at(time_s).head<2>();
      if (time_s > kTurn_s) position.p_map += off_m;
      position.covariance = 1e-2 * Eigen::Matrix2d::Identity();
      position.is_gnss = true;
      smoother.add(odometry.utime, position, truth_at(time_s));
    }
    smoother.finish(histories);
    const auto trajectory = smoother.take_correction();
    return trajectory ? trajectory->poses.back() : PoseEstimate{};
  };
  const auto utime = [](double time_s) { return static_cast<std::int64_t>(1e6 * time_s); };
  const std::vector<DisplacedTime> first{{utime(kTo_s), utime(kTurn_s), true}};
  const std::vector<DisplacedTime> second{{utime(kTurn_s) + 1, utime(kEnd_s), true}};
  const PoseEstimate by_first = end_of({{1.0, first}});
  const PoseEstimate by_second = end_of({{1.0, second}});
  ASSERT_NEAR(std::hypot(by_first.x_m - by_second.x_m, by_first.y_m - by_second.y_m), 8.0, 0.5);
  const PoseEstimate by_both = end_of({{0.75, second}, {0.25, first}});
  EXPECT_NEAR(by_both.x_m, 0.75 * by_second.x_m + 0.25 * by_first.x_m, 0.01);
  EXPECT_NEAR(by_both.y_m, 0.75 * by_second.y_m + 0.25 * by_first.y_m, 0.01);
  // Two points 8 m apart, three to one: 0.75 * 0.25 * 8^2 more.
  EXPECT_NEAR(by_both.covariance[0] + by_both.covariance[3],
              0.75 * (by_second.covariance[0] + by_second.covariance[3]) +
                  0.25 * (by_first.covariance[0] + by_first.covariance[3]) + 12.0,
              1.0);
}

}  // namespace
}  // namespace orchard::pose
