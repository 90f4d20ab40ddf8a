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

}  // namespace
}  // namespace orchard::mapping
