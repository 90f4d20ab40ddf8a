// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/degradation.hpp"

#include <gtest/gtest.h>

#include "geometry/angles.hpp"

namespace orchard::procs {
namespace {

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
