// SPDX-License-Identifier: BSD-3-Clause
// Truth: the definitions of the processes (fraction of time, autocorrelation of a Gauss-Markov
// error, lengths of gaps), over whole days.
#include "simulation/sensor/receiver_sky.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::simulation {
namespace {

constexpr double kDay_s = 86400.0;

TEST(ReceiverSky, IsOpenAndExactByDefault) {
  const ReceiverSky sky(1, {});
  for (double t = 0.0; t < 1000.0; t += 1.0) {
    ASSERT_TRUE(sky.is_open(t));
    ASSERT_EQ(sky.error_m(t).norm(), 0.0);
  }
}

TEST(ReceiverSky, GapsLastAsLongAsConfigured) {
  SkyConfig config;
  config.gap_every_s = 40.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const ReceiverSky sky(seed, config);
    int num_gaps = 0, num_long = 0;
    double since_s = -1.0;
    for (double t = 0.0; t < kDay_s; t += 0.5) {
      if (!sky.is_open(t)) {
        if (since_s < 0.0) since_s = t;
      } else if (since_s >= 0.0) {
        ++num_gaps;
        EXPECT_GE(t - since_s, 19.0);
        num_long += t - since_s > 181.0 ? 1 : 0;
        since_s = -1.0;
      }
    }
    EXPECT_LT(num_long, 0.03 * num_gaps);  // two with less than a step between them
    // 40 s with fixes and 72.8 s (160 / ln 9) without, in turn
    EXPECT_NEAR(num_gaps, kDay_s / 112.8, 100.0);
  }
}

TEST(ReceiverSky, BurstsAndPausesFractionTheTime) {
  SkyConfig config;
  config.burst_s = 6.0;
  config.pause_s = 3.0;
  const ReceiverSky sky(7, config);
  int open = 0;
  for (int i = 0; i < 86400; ++i) open += sky.is_open(i) ? 1 : 0;
  EXPECT_NEAR(open / kDay_s, 6.0 / 9.0, 0.02);
}

TEST(ReceiverSky, WanderingErrorForgetsItselfInItsTime) {
  SkyConfig config;
  config.wander_sd_m = 2.5;
  config.wander_time_s = 60.0;
  const ReceiverSky sky(3, config);
  double variance = 0.0, later = 0.0;
  int n = 0;
  for (double t = 0.0; t + 60.0 < kDay_s; t += 7.0) {
    const Eigen::Vector2d now = sky.error_m(t);
    variance += 0.5 * now.squaredNorm();
    later += 0.5 * now.dot(sky.error_m(t + 60.0));
    ++n;
  }
  EXPECT_NEAR(std::sqrt(variance / n), 2.5, 0.2);
  EXPECT_NEAR(later / variance, std::exp(-1.0), 0.08);
}

TEST(ReceiverSky, ReflectionsTakeTheirFractionAndHoldTheirError) {
  SkyConfig config;
  config.multipath_fraction = 0.05;
  const ReceiverSky sky(9, config);
  int reflected = 0, held = 0, pairs = 0;
  for (double t = 0.0; t + 0.5 < kDay_s; t += 0.5) {
    if (!sky.is_reflected(t)) {
      ASSERT_EQ(sky.error_m(t).norm(), 0.0);
      continue;
    }
    ++reflected;
    if (!sky.is_reflected(t + 0.5)) continue;
    ++pairs;
    held += sky.error_m(t) == sky.error_m(t + 0.5) ? 1 : 0;
  }
  EXPECT_NEAR(reflected * 0.5 / kDay_s, 0.05, 0.01);
  EXPECT_GT(held, 0.98 * pairs);
}

}  // namespace
}  // namespace orchard::simulation
