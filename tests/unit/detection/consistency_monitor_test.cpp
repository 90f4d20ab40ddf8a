// SPDX-License-Identifier: BSD-3-Clause
#include "detection/consistency_monitor.hpp"

#include <gtest/gtest.h>

#include <random>

namespace orchard::detection {
namespace {

constexpr double kFocal_px = 229.183;  // 4 px per degree

/// Looks at three objects every second for some seconds; every fifth is an outlier.
void watch(ConsistencyMonitor& monitor, std::int64_t& utime, double seconds, double offset_px) {
  std::mt19937 random(7);
  for (int i = 0; i < static_cast<int>(seconds); ++i) {
    utime += 1'000'000;
    std::vector<double> offsets_px;
    for (int k = 0; k < 3; ++k) {
      const double noise_px = static_cast<double>(random() % 201) * 0.01 - 1.0;
      offsets_px.push_back(random() % 5 == 0 ? -12.0 : offset_px + noise_px);
    }
    ASSERT_TRUE(monitor.is_due(utime));
    monitor.add(utime, offsets_px);
    ASSERT_FALSE(monitor.is_due(utime + 100'000));
  }
}

TEST(ConsistencyMonitor, WarnsAfterItsWindowAndClearsWithHysteresis) {
  ConsistencyMonitor monitor({}, kFocal_px);
  std::int64_t utime = 1'000'000;
  watch(monitor, utime, 19, 6.0);
  EXPECT_EQ(monitor.warning(), "");  // not for long yet
  watch(monitor, utime, 3, 6.0);
  EXPECT_NE(monitor.warning().find("laser and image edges disagree by 5."), std::string::npos)
      << monitor.warning();
  EXPECT_NE(monitor.warning().find("to the right"), std::string::npos);
  watch(monitor, utime, 30, 3.0);  // 0.7 deg: between the two limits
  EXPECT_TRUE(monitor.is_raised());
  watch(monitor, utime, 30, 0.5);
  EXPECT_FALSE(monitor.is_raised());
  EXPECT_EQ(monitor.warning(), "");
  watch(monitor, utime, 30, 3.0);
  EXPECT_FALSE(monitor.is_raised());
  EXPECT_NE(monitor.run_summary().find("disagreed by 5."), std::string::npos)
      << monitor.run_summary();
}

TEST(ConsistencyMonitor, FewObservationsSayNothing) {
  ConsistencyMonitor monitor({}, kFocal_px);
  for (int i = 0; i < 100; ++i) {
    monitor.add(1'000'000 + 500'000 * i,
                i % 4 == 0 ? std::vector<double>{9.0} : std::vector<double>{});
  }
  EXPECT_EQ(monitor.num_observations(), 10);
  EXPECT_EQ(monitor.warning(), "");
  EXPECT_EQ(monitor.run_summary(), "");
}

/// Among bushes edges are found anywhere in the search window, of 16 px to both sides here.
TEST(ConsistencyMonitor, EdgesOfBushesAreNoDisagreement) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    ConsistencyMonitor monitor({}, kFocal_px);
    std::mt19937 random(seed);
    std::int64_t utime = 1'000'000;
    for (int i = 0; i < 600; ++i) {
      utime += 500'000;
      monitor.add(utime, {static_cast<double>(random() % 33) - 16.0});
    }
    EXPECT_EQ(monitor.run_summary(), "") << "seed " << seed;
  }
}

TEST(ConsistencyMonitor, OffMeansOff) {
  ConsistencyConfig config;
  config.enabled = false;
  EXPECT_FALSE(ConsistencyMonitor(config, kFocal_px).is_due(1'000'000));
}

}  // namespace
}  // namespace orchard::detection
