// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/steady_motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace orchard::pose {
namespace {

const Eigen::Vector3d kPerSecond(0.5, 0.0, 0.1);
constexpr std::array<double, 5> kIntervals_s{0.1, 0.6, 0.1, 1.2, 0.3};

TEST(SteadyMotion, KnowsNothingAtFirst) {
  const SteadyMotion::Forecast forecast = SteadyMotion().forecast(0.1);
  EXPECT_EQ(forecast.T_from_to.norm(), 0.0);
  EXPECT_EQ(forecast.covariance, unknown_motion());
}

TEST(SteadyMotion, OfASteadyRobotIsPerSecondWhereScansComeUnevenly) {
  SteadyMotion motion;
  for (int i = 0; i < 50; ++i) {
    const double dt_s = kIntervals_s[i % kIntervals_s.size()];
    motion.add(dt_s * kPerSecond, dt_s, true);
  }
  const SteadyMotion::Forecast forecast = motion.forecast(1.0);
  EXPECT_LT((forecast.T_from_to - kPerSecond).norm(), 0.01);
  EXPECT_LT(forecast.covariance.trace(), 0.1 * unknown_motion().trace());
}

TEST(SteadyMotion, IsPerScanWhereTheClockIsStretched) {
  SteadyMotion motion;
  for (int i = 0; i < 50; ++i) {
    motion.add(0.4 * kPerSecond, kIntervals_s[i % kIntervals_s.size()], true);
  }
  EXPECT_LT((motion.forecast(1.2).T_from_to - 0.4 * kPerSecond).norm(), 1e-9);
}

TEST(SteadyMotion, DoesNotGoOnForLongerThanWasEverSeen) {
  SteadyMotion motion;
  for (int i = 0; i < 50; ++i) {
    const double dt_s = kIntervals_s[i % kIntervals_s.size()];
    motion.add(dt_s * kPerSecond, dt_s, true);
  }
  EXPECT_LT((motion.forecast(700.0).T_from_to - 1.2 * kPerSecond).norm(), 0.05);
}

TEST(SteadyMotion, WhatIsNotSeenJudgesNoForecast) {
  SteadyMotion motion;
  for (int i = 0; i < 50; ++i) motion.add(0.1 * kPerSecond, 0.1, false);
  EXPECT_EQ(motion.forecast(0.1).covariance, unknown_motion());
}

TEST(SteadyMotion, WhatIsUnseenForLongIsAsGoodAsUnknown) {
  SteadyMotion motion;
  for (int i = 0; i < 60; ++i) {
    const double speed = 0.5 + 0.1 * (i % 2);
    motion.add({0.3 * speed, 0.0, 0.0}, 0.3, true);
  }
  // The robot stops where no scan tells anything. What it is told to have gone is wrong by more
  // with every scan, and said to be.
  double error_m = 0.0, variance_m2 = 0.0;
  for (int i = 0; i < 20; ++i) {
    const SteadyMotion::Forecast forecast = motion.forecast(0.3);
    error_m += forecast.T_from_to.x();
    variance_m2 += forecast.covariance(0, 0);
    motion.add(forecast.T_from_to, 0.3, false);
  }
  EXPECT_GT(error_m, 1.0);
  EXPECT_LT(error_m, 4.0 * std::sqrt(variance_m2));
}

TEST(SteadyMotion, ARobotThatStartsAndStopsIsForetoldLessSurely) {
  SteadyMotion steady, jerky;
  for (int i = 0; i < 60; ++i) {
    steady.add(0.3 * kPerSecond, 0.3, true);
    jerky.add(i / 5 % 2 == 0 ? Eigen::Vector3d(0.3 * kPerSecond) : Eigen::Vector3d::Zero(), 0.3,
              true);
  }
  EXPECT_LT(steady.forecast(0.3).covariance(0, 0), 1e-3);
  EXPECT_GT(jerky.forecast(0.3).covariance(0, 0), 1e-3);
}

}  // namespace
}  // namespace orchard::pose
