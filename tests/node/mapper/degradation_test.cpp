// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/degradation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angles.hpp"

namespace orchard::procs {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr std::int64_t kSecond_us = 1'000'000;

/// A minute of scans at 10 Hz, one new landmark a second; without pictures from 20 to 30 s.
void drive(Degradation& degradation) {
  for (int k = 0; k <= 600; ++k) {
    const std::int64_t utime = kSecond_us + 100'000 * k;
    const bool has_picture = k <= 200 || k > 300;
    degradation.note_scan(utime, has_picture ? utime : 0, 1 + k / 10);
  }
}

TEST(Degradation, AStretchWithoutPicturesIsToldWithItsLandmarks) {
  Degradation degradation(true);
  drive(degradation);
  const auto stretches = degradation.intervals();
  ASSERT_THAT(stretches, SizeIs(1));
  EXPECT_EQ(stretches[0].missing, "IMAGE");
  EXPECT_EQ(stretches[0].first_utime, 21 * kSecond_us);  // the last scan that had one
  EXPECT_EQ(stretches[0].last_utime, 31 * kSecond_us);
  EXPECT_EQ(stretches[0].first_id, 22);
  EXPECT_EQ(stretches[0].last_id, 31);
  EXPECT_THAT(degradation.text(), HasSubstr("no IMAGE for 10.0 s in 1 interval while"));
  EXPECT_THAT(degradation.text(), HasSubstr("10 landmarks were first seen then"));
}

TEST(Degradation, ARigWithoutACameraOrReceiverLacksNothing) {
  Degradation degradation(false);
  drive(degradation);
  EXPECT_THAT(degradation.intervals(), SizeIs(0));
  EXPECT_EQ(degradation.text(), "");
}

TEST(Degradation, ARobotThatPausesLacksNothing) {
  Degradation degradation(false);
  for (int k = 0; k < 60; ++k) {  // after each ten scans with their fixes it stands for ten minutes
    const std::int64_t utime = kSecond_us + 1'000'000 * k + 600 * kSecond_us * (k / 10);
    degradation.note_scan(utime, 0, k);
    degradation.note_fix(utime);
  }
  EXPECT_THAT(degradation.intervals(), SizeIs(0));
}

TEST(Degradation, PicturesNowAndThenAreEnough) {
  Degradation degradation(true);
  for (int k = 0; k < 600; ++k) {
    degradation.note_scan(kSecond_us + 100'000 * k, k % 20 == 0 ? kSecond_us : 0, 1);
  }
  EXPECT_THAT(degradation.intervals(), SizeIs(0));
}

TEST(Degradation, FixesThatStopAreToldWhicheverChannelCameFirst) {
  for (const bool fixes_first : {true, false}) {
    Degradation degradation(false);
    const auto fixes = [&] {
      for (int k = 0; k <= 60; ++k) {  // none from 10 to 40 s, and none after 55 s
        if ((k > 10 && k < 40) || k > 50) continue;
        degradation.note_fix(kSecond_us + kSecond_us * k);
      }
    };
    if (fixes_first) fixes();
    drive(degradation);
    if (!fixes_first) fixes();
    const auto stretches = degradation.intervals();
    ASSERT_THAT(stretches, SizeIs(2));
    EXPECT_EQ(stretches[0].missing, "GNSS");
    EXPECT_EQ(stretches[0].first_utime, 11 * kSecond_us);
    EXPECT_EQ(stretches[0].last_utime, 41 * kSecond_us);
    EXPECT_EQ(stretches[1].first_utime, 51 * kSecond_us);
    EXPECT_EQ(stretches[1].last_utime, 61 * kSecond_us);
  }
}

TEST(Degradation, WhatIsMissingNowIsKnownAtOnceAndOverWhenItIsBack) {
  Degradation degradation(true);
  degradation.note_scan(kSecond_us, kSecond_us, 1);
  degradation.note_scan(3 * kSecond_us, 0, 1);
  EXPECT_FALSE(degradation.lacks_pictures_now());
  degradation.note_scan(5 * kSecond_us, 0, 1);
  EXPECT_TRUE(degradation.lacks_pictures_now());
  degradation.note_scan(6 * kSecond_us, 6 * kSecond_us, 1);
  EXPECT_FALSE(degradation.lacks_pictures_now());
}

laser::Scan half_turn(double beam_period_us) {
  laser::Scan scan;
  scan.bearing_step_rad = geometry::kPi / 180.0;
  scan.beam_period_us = beam_period_us;
  scan.range_min_m = 0.1;
  scan.range_max_m = 10.0;
  scan.ranges_m.assign(180, 4.0f);
  return scan;
}

/// A robot at 1 m/s, or one that turns, at ten scans a second.
std::string drive(double beam_period_us, double speed_mps, double yaw_rate_radps,
                  double period_s = 0.1) {
  BeamTimes times(0.02, 0.25);
  for (int i = 0; i < 100; ++i) {
    const double t_s = period_s * i;
    times.note_scan(half_turn(beam_period_us));
    times.note_pose(static_cast<std::int64_t>(1e6 * (1.0 + t_s)),
                    {speed_mps * t_s, 0.0, geometry::wrap_angle_rad(yaw_rate_radps * t_s)});
  }
  return times.text();
}

TEST(BeamTimes, AMovingRobotWithoutThemIsTold) {
  // half of 0.1 m per scan
  EXPECT_NE(
      drive(0.0, 1.0, 0.0).find("99 of 99 scans, so landmarks may be displaced by about 0.05 m"),
      std::string::npos);
  // half of 0.05 rad at 4 m
  EXPECT_NE(drive(0.0, 0.0, 0.5).find("by about 0.10 m"), std::string::npos);
}

TEST(BeamTimes, NobodyElseIs) {
  EXPECT_EQ(drive(100.0, 1.0, 0.0), "");     // the scanner says them
  EXPECT_EQ(drive(0.0, 0.1, 0.0), "");       // less than the noise of a range
  EXPECT_EQ(drive(0.0, 1.0, 0.0, 1.0), "");  // measured at stops
}

}  // namespace

}  // namespace orchard::procs
