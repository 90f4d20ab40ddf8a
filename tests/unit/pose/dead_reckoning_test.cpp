// SPDX-License-Identifier: BSD-3-Clause
#include "pose/motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kSpeed_mps = 1.0;
constexpr double kTurn_radps = 0.8;

/// Heading of a robot that begins to turn at once at 1.03 s and ceases at 2.57 s.
double yaw_at(double t_s) { return kTurn_radps * (std::clamp(t_s, 1.03, 2.57) - 1.03); }

std::int64_t utime_at(double t_s) { return std::llround(1e6 * t_s) + 1; }

/// Encoders count what was turned since the reading before.
Odometry reading(int i) {
  Odometry odometry;
  odometry.utime = utime_at(i * kPeriod_s);
  odometry.speed_mps = kSpeed_mps;
  odometry.yaw_rate_radps = (yaw_at(i * kPeriod_s) - yaw_at((i - 1) * kPeriod_s)) / kPeriod_s;
  return odometry;
}

TEST(DeadReckoning, AReadingIsTheMeanSinceTheOneBefore) {
  DeadReckoning motion{SlamConfig{}};
  for (int i = 0; i <= 40; ++i) {
    motion.add(reading(i));
    EXPECT_NEAR(motion.motion().delta.z(), yaw_at(i * kPeriod_s), 1e-9) << i;
  }
}

TEST(DeadReckoning, ReadingsOfTheMomentLieWithinItsUncertainty) {
  DeadReckoning counted{SlamConfig{}};
  counted.set_default_noise(0.0, 0.0);
  Odometry odometry;
  odometry.utime = utime_at(0.0);
  counted.add(odometry);
  odometry.utime = utime_at(kPeriod_s);
  odometry.yaw_rate_radps = kTurn_radps;
  counted.add(odometry);
  // evenly between none and all of the turn
  EXPECT_NEAR(std::sqrt(counted.motion().covariance(2, 2)), kTurn_radps * kPeriod_s / std::sqrt(12),
              1e-6);
}

}  // namespace
}  // namespace orchard::pose
