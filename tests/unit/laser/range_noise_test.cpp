// SPDX-License-Identifier: BSD-3-Clause
#include "laser/range_noise.hpp"

#include <gtest/gtest.h>

#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

/// Trunks about the scanner, each with a score of beams, and a bush whose leaves lie anywhere.
RangeNoise seen(double stated_sd_m, double true_sd_m, int num_scans, bool has_bushes) {
  test::Scanner scanner = test::field_scanner();
  scanner.range_sd_m = true_sd_m;
  LaserConfig laser;
  laser.range_sd_m = stated_sd_m;
  laser.range_sd_fraction = 0.0;
  RangeNoise range_noise(laser, {}, 8.0, 0.15);
  test::Noise noise(3);
  for (int i = 0; i < num_scans; ++i) {
    const double at_m = 0.01 * i;
    test::Things things;
    for (const double bearing : {-1.2, -0.4, 0.3, 1.1}) {
      things.discs.push_back(
          {(2.0 + at_m) * std::cos(bearing), (2.0 + at_m) * std::sin(bearing), 0.1});
    }
    Scan scan = test::noisy_scan(things, scanner, noise);
    for (std::size_t beam = 0; has_bushes && beam < 60; ++beam) {
      scan.ranges_m[beam] = static_cast<float>(3.0 + 0.05 * noise.normal());
    }
    range_noise.add(scan);
  }
  return range_noise;
}

TEST(RangeNoise, ARightRigIsNotDoubted) {
  for (const bool has_bushes : {false, true}) {
    const RangeNoise noise = seen(0.01, 0.01, 300, has_bushes);
    ASSERT_TRUE(noise.ratio());
    EXPECT_GT(*noise.ratio(), 0.7);
    EXPECT_LT(*noise.ratio(), 1.3);
    EXPECT_FALSE(noise.finding());
  }
}

TEST(RangeNoise, AThirdOfTheNoiseIsNamed) {
  const RangeNoise noise = seen(0.0033, 0.01, 300, true);
  ASSERT_TRUE(noise.finding());
  EXPECT_EQ(noise.finding()->name, "range_sd");
  EXPECT_EQ(noise.finding()->key, "laser.range_sd_m");
}

TEST(RangeNoise, AFewSurfacesSayNothing) { EXPECT_FALSE(seen(0.001, 0.01, 10, false).ratio()); }

}  // namespace
}  // namespace orchard::laser
