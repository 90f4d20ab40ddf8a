// SPDX-License-Identifier: BSD-3-Clause
#include "pose/rig/reference_path.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::pose {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

Odometry wheels(double time_s, double speed_mps, double yaw_rate_radps) {
  Odometry odometry;
  odometry.utime = static_cast<std::int64_t>(time_s * 1e6);
  odometry.speed_mps = speed_mps;
  odometry.yaw_rate_radps = yaw_rate_radps;
  return odometry;
}

TEST(ReferencePath, WheelsDriveACircle) {
  ReferencePath path;
  for (int i = 0; i <= 20; ++i) path.add(wheels(0.5 * i, 1.0, 0.5));
  ASSERT_EQ(path.reached_utime(), 10 * kSecond_us);
  // Of radius 2 m about (0, 2); also between two readings.
  for (const double time_s : {0.5, 1.3, 4.75, 9.9}) {
    const auto place = path.at(static_cast<std::int64_t>(time_s * 1e6));
    ASSERT_TRUE(place);
    EXPECT_NEAR(place->T_path_base.x(), 2.0 * std::sin(0.5 * time_s), 1e-9);
    EXPECT_NEAR(place->T_path_base.y(), 2.0 - 2.0 * std::cos(0.5 * time_s), 1e-9);
  }
  EXPECT_FALSE(path.at(-1));
  EXPECT_FALSE(path.at(11 * kSecond_us));
  path.forget_before(5 * kSecond_us);
  EXPECT_FALSE(path.at(3 * kSecond_us));
  EXPECT_TRUE(path.at(5 * kSecond_us));
}

TEST(ReferencePath, NothingIsKnownAcrossAGap) {
  ReferencePath path;
  path.add(wheels(0.0, 1.0, 0.0));
  path.add(wheels(0.5, 1.0, 0.0));
  path.add(wheels(2.5, 1.0, 0.0));
  path.add(wheels(2.4, 9.0, 0.0));  // late: ignored
  path.add(wheels(3.0, 1.0, 0.0));
  EXPECT_FALSE(path.at(kSecond_us));
  EXPECT_EQ(path.at(kSecond_us / 2)->piece, 0);
  EXPECT_EQ(path.at(3 * kSecond_us)->piece, 1);
  EXPECT_NEAR(path.at(3 * kSecond_us)->T_path_base.x(), 1.0, 1e-12);
}

TEST(ReferencePath, FixesAreKnownAtTheirTimesAndBetweenNeighbours) {
  ReferencePath path;
  PoseFix fix;
  fix.x_m = 3.0;
  fix.yaw_rad = 3.1;
  path.add(fix);
  fix.utime = kSecond_us;
  fix.x_m = 2.0;
  fix.yaw_rad = -3.1;  // a small turn across half a turn
  path.add(fix);
  fix.utime = 20 * kSecond_us;
  path.add(fix);
  fix.utime = 21 * kSecond_us;
  fix.has_yaw = false;
  path.add(fix);
  EXPECT_NEAR(path.at(kSecond_us / 2)->T_path_base.x(), 2.5, 1e-3);
  EXPECT_NEAR(std::abs(path.at(kSecond_us / 2)->T_path_base.z()), 3.14159, 1e-3);
  EXPECT_FALSE(path.at(10 * kSecond_us));
  EXPECT_TRUE(path.at(20 * kSecond_us));
  EXPECT_FALSE(path.at(21 * kSecond_us));
}

}  // namespace
}  // namespace orchard::pose
