// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/leveller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <variant>
#include <vector>

namespace orchard::pose {
namespace {

LevellingConfig rig() {
  LevellingConfig config;
  config.laser.height_m = 0.5;
  config.has_wheels = true;
  return config;
}

Imu tilted(std::int64_t utime, double pitch_rad) {
  Imu imu;
  imu.utime = utime;
  imu.has_orientation = true;
  imu.pitch_rad = pitch_rad;
  imu.angular_rate_radps[2] = 0.5;
  return imu;
}

Odometry wheels(std::int64_t utime) {
  Odometry odometry;
  odometry.utime = utime;
  odometry.speed_mps = 2.0;
  odometry.yaw_rate_radps = 0.5;
  return odometry;
}

laser::Scan sweep(std::int64_t utime) {
  laser::Scan scan;
  scan.utime = utime;
  scan.bearing_min_rad = -1.0;
  scan.bearing_step_rad = 0.02;
  scan.beam_period_us = 500.0;
  scan.range_min_m = 0.1;
  scan.range_max_m = 30.0;
  scan.ranges_m.assign(101, 2.0f);
  return scan;
}

std::vector<Leveller::Input> all_of(Leveller& leveller) {
  std::vector<Leveller::Input> all;
  while (auto next = leveller.take()) all.push_back(*std::move(next));
  return all;
}

TEST(Leveller, AScanWaitsForTheTiltAtItsLastBeam) {
  Leveller leveller(rig());
  leveller.add(tilted(1'000'000, -0.1));
  leveller.add(wheels(1'000'000));
  leveller.add(sweep(1'000'000));  // up to 1.050 s
  EXPECT_EQ(all_of(leveller).size(), 2u);
  leveller.add(tilted(1'020'000, -0.1));
  leveller.add(wheels(1'020'000));
  for (const auto& other : all_of(leveller))
    EXPECT_FALSE(std::holds_alternative<laser::Scan>(other));
  leveller.add(wheels(1'060'000));
  leveller.add(tilted(1'060'000, -0.1));
  const auto ready = all_of(leveller);
  ASSERT_EQ(ready.size(), 3u);
  const auto* scan = std::get_if<laser::Scan>(&ready[1]);  // after the IMU, before the wheels
  ASSERT_NE(scan, nullptr);
  EXPECT_NEAR(scan->ranges_m[50], 2.0 * std::cos(0.1), 1e-5);  // ahead, uphill
  EXPECT_TRUE(leveller.warning().empty());
}

TEST(Leveller, WheelsAndRatesAreThoseOfTheMap) {
  Leveller leveller(rig());
  leveller.add(tilted(1'000'000, -0.2));
  leveller.add(wheels(1'000'000));
  const auto ready = all_of(leveller);
  ASSERT_EQ(ready.size(), 2u);
  EXPECT_NEAR(std::get<Imu>(ready[0]).angular_rate_radps[2], 0.5 / std::cos(0.2), 1e-12);
  EXPECT_NEAR(std::get<Odometry>(ready[1]).speed_mps, 2.0 * std::cos(0.2), 1e-12);
  EXPECT_NEAR(std::get<Odometry>(ready[1]).yaw_rate_radps, 0.5 / std::cos(0.2), 1e-12);
}

TEST(Leveller, GoesOnWithoutAnImuAndSaysSo) {
  Leveller leveller(rig());
  const laser::Scan before = sweep(1'000'000);
  leveller.add(before);
  EXPECT_TRUE(all_of(leveller).empty());
  for (int i = 0; i < 6; ++i) leveller.add(wheels(1'000'000 + 20'000 * i));
  leveller.add(wheels(1'700'000));
  bool is_there = false;
  for (const auto& input : all_of(leveller)) {
    const auto* scan = std::get_if<laser::Scan>(&input);
    if (scan == nullptr) continue;
    is_there = true;
    EXPECT_EQ(scan->ranges_m, before.ranges_m);
    EXPECT_TRUE(scan->bearings_rad.empty());
  }
  EXPECT_TRUE(is_there);
  EXPECT_NE(leveller.warning().find("laser.height_m"), std::string::npos) << leveller.warning();
}

// A scan that arrives before its last beam's time does not make others late.
TEST(Leveller, TheOrderOfArrivalDoesNotMatter) {
  std::vector<double> reference;
  for (const bool imu_first : {true, false}) {
    Leveller leveller(rig());
    std::vector<double> told;
    const auto drain = [&] {
      for (const auto& input : all_of(leveller)) {
        const auto* odometry = std::get_if<Odometry>(&input);
        if (odometry != nullptr) told.push_back(odometry->speed_mps);
        const auto* scan = std::get_if<laser::Scan>(&input);
        if (scan != nullptr) told.push_back(scan->ranges_m[50]);
      }
    };
    for (int i = 0; i < 100; ++i) {
      const std::int64_t utime = 1'000'000 + 20'000 * i;
      if (i % 5 == 0) leveller.add(sweep(utime));
      const Imu imu = tilted(utime, 0.002 * i);
      if (imu_first) leveller.add(imu);
      drain();
      leveller.add(wheels(utime));
      drain();
      if (!imu_first) leveller.add(imu);
      drain();
    }
    if (imu_first) reference = told;
    EXPECT_EQ(told, reference);
    EXPECT_GE(told.size(), 115u);
  }
}

TEST(Leveller, GivesWhatWaitsAtTheEnd) {
  Leveller leveller(rig());
  leveller.add(sweep(1'000'000));
  EXPECT_FALSE(leveller.take());
  const auto last = leveller.take_flushed();
  ASSERT_TRUE(last);
  EXPECT_TRUE(std::holds_alternative<laser::Scan>(*last));
  EXPECT_FALSE(leveller.take_flushed());
}

}  // namespace
}  // namespace orchard::pose
