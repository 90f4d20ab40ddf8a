// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_track.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::mapping {
namespace {

pose::PoseEstimate pose_at(std::int64_t utime, double x_m, double yaw_rad) {
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = x_m;
  pose.yaw_rad = yaw_rad;
  pose.covariance = {x_m, 0, 0, 0, 0, 0};
  return pose;
}

TEST(PoseTrack, GoesStraightAndTurnsTheShortWay) {
  PoseTrack track(2.0);
  track.add(pose_at(1000000, 1.0, 3.1));
  track.add(pose_at(0, 0.0, -3.1));
  const auto pose = track.at(500000);
  ASSERT_TRUE(pose.has_value());
  EXPECT_DOUBLE_EQ(pose->x_m, 0.5);
  EXPECT_DOUBLE_EQ(pose->covariance[0], 0.5);
  EXPECT_NEAR(std::abs(pose->yaw_rad), 3.14159265358979, 1e-9);
  EXPECT_EQ(pose->utime, 500000);
}

TEST(PoseTrack, DoesNotCrossGaps) {
  PoseTrack track(2.0);
  EXPECT_FALSE(track.at(0).has_value());
  track.add(pose_at(0, 0.0, 0.0));
  track.add(pose_at(5000000, 1.0, 0.0));
  EXPECT_FALSE(track.at(2500000).has_value());
  EXPECT_TRUE(track.at(5000000).has_value());
  EXPECT_TRUE(track.covers(5000000));
  EXPECT_FALSE(track.covers(5000001));
}

TEST(PoseTrack, IsNotTakenBeyondItsEnds) {
  PoseTrack track(2.0);
  track.add(pose_at(1000000, 0.0, 0.0));
  track.add(pose_at(2000000, 1.0, 0.0));
  EXPECT_TRUE(track.at(2100000).has_value());
  EXPECT_FALSE(track.at(2100001).has_value());
  EXPECT_TRUE(track.at(900000).has_value());
  EXPECT_FALSE(track.at(899999).has_value());
}

pose::Trajectory trajectory_of(std::int64_t utime, std::vector<pose::PoseEstimate> poses) {
  pose::Trajectory trajectory;
  trajectory.utime = utime;
  trajectory.poses = std::move(poses);
  return trajectory;
}

TEST(PoseTrack, ACorrectionTurnsThePastAsAWhole) {
  // Told: straight along x. Known later: turned by a quarter about (10, 0).
  PoseTrack track(2.0);
  for (int i = 0; i <= 4; ++i) track.add(pose_at(1000000 * i, i, 0.0));
  pose::PoseEstimate key = pose_at(0, 10.0, geometry::kPi / 2);
  const double moved_m = track.correct(trajectory_of(5000000, {key}));
  const auto pose = track.at(4000000);
  EXPECT_NEAR(pose->x_m, 10.0, 1e-12);
  EXPECT_NEAR(pose->y_m, 4.0, 1e-12);
  EXPECT_NEAR(pose->yaw_rad, geometry::kPi / 2, 1e-12);
  EXPECT_NEAR(moved_m, 10.0, 1e-12);
}

TEST(PoseTrack, BetweenKeyTimesTheCorrectionIsInterpolatedAndTheMotionKept) {
  // Told with a wiggle that lies between the key times and must survive.
  PoseTrack track(2.0);
  for (int i = 0; i <= 4; ++i) {
    pose::PoseEstimate pose = pose_at(1000000 * i, i, 0.0);
    pose.y_m = i == 2 ? 0.25 : 0.0;
    track.add(pose);
  }
  pose::PoseEstimate first = pose_at(0, 0.0, 0.0);
  pose::PoseEstimate last = pose_at(4000000, 4.0, 0.0);
  last.y_m = 1.0;
  track.correct(trajectory_of(4000001, {first, last}));
  EXPECT_NEAR(track.at(0)->y_m, 0.0, 1e-12);
  EXPECT_NEAR(track.at(1000000)->y_m, 0.25, 1e-12);
  EXPECT_NEAR(track.at(2000000)->y_m, 0.5 + 0.25, 1e-12);
  EXPECT_NEAR(track.at(4000000)->y_m, 1.0, 1e-12);
}

TEST(PoseTrack, AJumpWithKeyPosesAtBothSidesIsGone) {
  // Told: along x at 1 m/s, but 98 m aside from 1.988 s on and back from 3 s on.
  PoseTrack track(2.0);
  const auto told = [](std::int64_t utime) {
    pose::PoseEstimate pose = pose_at(utime, 1e-6 * static_cast<double>(utime), 0.0);
    pose.y_m = utime >= 1988000 && utime < 3000000 ? 98.0 : 0.0;
    return pose;
  };
  std::vector<std::int64_t> times{1976000, 1988000};
  for (std::int64_t t = 0; t <= 5000000; t += 100000) times.push_back(t);
  for (const std::int64_t t : times) track.add(told(t));
  std::vector<pose::PoseEstimate> keys;
  for (const std::int64_t t : {0, 1500000, 1976000, 1988000, 2900000, 3000000, 4500000}) {
    keys.push_back(pose_at(t, 1e-6 * static_cast<double>(t), 0.0));
  }
  track.correct(trajectory_of(5000001, keys));
  for (const pose::PoseEstimate& pose : track.poses()) {
    EXPECT_NEAR(pose.x_m, 1e-6 * static_cast<double>(pose.utime), 1e-9);
    EXPECT_NEAR(pose.y_m, 0.0, 1e-9);
  }
}

TEST(PoseTrack, PosesToldWithTheCorrectionAreLeftAsTheyAre) {
  PoseTrack track(2.0);
  track.add(pose_at(0, 0.0, 0.0));
  track.add(pose_at(1000000, 1.0, 0.0));
  track.add(pose_at(2000000, 7.0, 0.0));  // told after it
  const double moved_m = track.correct(
      trajectory_of(2000000, {pose_at(1000000, 6.0, 0.0), pose_at(2000000, 7.0, 0.0)}));
  EXPECT_DOUBLE_EQ(track.at(0)->x_m, 5.0);
  EXPECT_DOUBLE_EQ(track.at(1000000)->x_m, 6.0);
  EXPECT_DOUBLE_EQ(track.at(2000000)->x_m, 7.0);
  EXPECT_DOUBLE_EQ(moved_m, 5.0);
}

TEST(PoseTrack, ATrajectoryOfAnotherTimeMovesNothing) {
  PoseTrack track(2.0);
  EXPECT_EQ(track.correct(trajectory_of(10, {pose_at(5, 1.0, 0.0)})), 0.0);
  track.add(pose_at(1000000, 1.0, 0.0));
  EXPECT_EQ(track.correct(trajectory_of(10, {pose_at(5, 1.0, 0.0)})), 0.0);
  EXPECT_EQ(track.correct(trajectory_of(9000000, {pose_at(8000000, 3.0, 0.0)})), 0.0);
  EXPECT_EQ(track.correct(trajectory_of(9000000, {})), 0.0);
  EXPECT_DOUBLE_EQ(track.at(1000000)->x_m, 1.0);
}

constexpr double kSpeed_mps = 1.0;
constexpr double kYawRate_radps = 0.5;

/// A robot on a circle: where it is, by the circle's equation.
pose::PoseEstimate pose_at(std::int64_t utime) {
  const double t_s = 1e-6 * static_cast<double>(utime);
  const double radius_m = kSpeed_mps / kYawRate_radps;
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.yaw_rad = kYawRate_radps * t_s;
  pose.x_m = radius_m * std::sin(pose.yaw_rad);
  pose.y_m = radius_m * (1.0 - std::cos(pose.yaw_rad));
  return pose;
}

/// A point of map as base at a pose has it.
void place(double x_map_m, double y_map_m, const pose::PoseEstimate& pose, double& x, double& y) {
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  x = c * (x_map_m - pose.x_m) + s * (y_map_m - pose.y_m);
  y = -s * (x_map_m - pose.x_m) + c * (y_map_m - pose.y_m);
}

TEST(Sweep, EveryObjectIsPutWhereTheScansPoseHasIt) {
  PoseTrack track(2.0);
  for (int k = 0; k <= 60; ++k) track.add(pose_at(20'000 * k));
  const std::int64_t scan_utime = 500'000;
  detection::Detections seen;
  seen.utime = scan_utime;
  for (const std::int64_t after_us : {0, 20'000, 37'500, 74'000}) {
    detection::Detection d;
    d.utime = scan_utime + after_us;
    place(3.0, 1.0, pose_at(d.utime), d.centre_x_m, d.centre_y_m);
    place(2.9, 1.0, pose_at(d.utime), d.surface_x_m, d.surface_y_m);
    d.covariance = {4e-4, 1e-4, 1e-4};
    seen.trunks.push_back(d);
  }
  EXPECT_EQ(last_utime_of(seen), scan_utime + 74'000);
  double x = 0.0, y = 0.0, surface_x = 0.0, surface_y = 0.0;
  place(3.0, 1.0, pose_at(scan_utime), x, y);
  place(2.9, 1.0, pose_at(scan_utime), surface_x, surface_y);
  EXPECT_GT(std::hypot(seen.trunks[3].centre_x_m - x, seen.trunks[3].centre_y_m - y), 0.05);
  for (const auto& d : deskewed(seen, track, pose_at(scan_utime)).trunks) {
    EXPECT_NEAR(d.centre_x_m, x, 1e-4);  // the track goes straight between poses
    EXPECT_NEAR(d.centre_y_m, y, 1e-4);
    EXPECT_NEAR(d.surface_x_m, surface_x, 1e-4);
    EXPECT_NEAR(d.surface_y_m, surface_y, 1e-4);
    EXPECT_NEAR(d.covariance[0] + d.covariance[2], 5e-4, 1e-9);
  }
}

TEST(Sweep, CovarianceTurnsWithTheRobot) {
  PoseTrack track(2.0);
  track.add(pose_at(0));
  pose::PoseEstimate turned = pose_at(0);
  turned.utime = 100'000;
  turned.yaw_rad = 1.0;
  track.add(turned);
  detection::Detections seen;
  detection::Detection d;
  d.utime = 100'000;
  d.covariance = {9e-4, 0.0, 1e-4};  // long ahead of the turned robot
  seen.trunks.push_back(d);
  const auto c = deskewed(seen, track, pose_at(0)).trunks.at(0).covariance;
  EXPECT_NEAR(std::cos(1.0) * std::cos(1.0) * 9e-4 + std::sin(1.0) * std::sin(1.0) * 1e-4, c[0],
              1e-9);
  EXPECT_NEAR(std::cos(1.0) * std::sin(1.0) * 8e-4, c[1], 1e-9);
}

TEST(Sweep, TimesThatAreNoneOfTheScanChangeNothing) {
  PoseTrack track(10.0);
  track.add(pose_at(0));
  track.add(pose_at(9'000'000));
  detection::Detections seen;
  seen.utime = 4'000'000;
  for (const std::int64_t utime : {std::int64_t{0}, std::int64_t{6'000'000}}) {
    detection::Detection d;
    d.utime = utime;
    d.centre_x_m = 2.0;
    seen.trunks.push_back(d);
  }
  EXPECT_EQ(last_utime_of(seen), 4'000'000);
  for (const auto& d : deskewed(seen, track, pose_at(4'000'000)).trunks) {
    EXPECT_EQ(d.centre_x_m, 2.0);
  }
}

TEST(Sweep, PosesAreDenseWhenTheLastTwoAreNear) {
  PoseTrack track(10.0);
  track.add(pose_at(0));
  EXPECT_FALSE(track.is_dense_at(0, 250'000));
  track.add(pose_at(100'000));
  track.add(pose_at(1'100'000));
  EXPECT_TRUE(track.is_dense_at(100'000, 250'000));
  EXPECT_TRUE(track.is_dense_at(1'000'000, 250'000));
  EXPECT_FALSE(track.is_dense_at(1'100'000, 250'000));
}

}  // namespace

}  // namespace orchard::mapping
