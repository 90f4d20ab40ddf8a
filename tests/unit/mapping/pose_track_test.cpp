// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_track.hpp"

#include <gtest/gtest.h>

#include <cmath>

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
  EXPECT_TRUE(track.at(6500000).has_value());
  EXPECT_FALSE(track.at(7500000).has_value());
  EXPECT_TRUE(track.covers(5000000));
  EXPECT_FALSE(track.covers(5000001));
}

}  // namespace
}  // namespace orchard::mapping
