// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/pose_track.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::mapping {
namespace {

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
