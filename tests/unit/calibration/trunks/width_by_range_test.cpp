// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/width_by_range.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace orchard::calibration {
namespace {

constexpr double kStep_rad = 0.00436;

double normal(std::mt19937_64& random) {
  const double u = (static_cast<double>(random() >> 11) + 0.5) / 9007199254740992.0;
  const double v = static_cast<double>(random() >> 11) / 9007199254740992.0;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(6.283185307179586 * v);
}

/// Looks whose scatter follows the law with sd_m and growth, from 1 m to `far_m`.
std::vector<WidthObservation> observations_with(double sd_m, double growth, double far_m, int n) {
  std::mt19937_64 random(11);
  std::vector<WidthObservation> observations;
  for (int i = 0; i < n; ++i) {
    const double range_m = 1.0 + (far_m - 1.0) * i / n;
    const double sd = std::hypot(sd_m, growth * range_m * kStep_rad);
    observations.push_back({range_m, kStep_rad, 0.12 + sd * normal(random)});
  }
  return observations;
}

TEST(WidthByRange, FindsTheLawThatScatterFollows) {
  const WidthByRange width = width_by_range(observations_with(0.010, 0.8, 6.0, 3000));
  ASSERT_TRUE(width.has_growth);
  EXPECT_NEAR(width.sd_m, 0.010, 0.001);
  EXPECT_NEAR(width.sd_per_beam_step, 0.8, 0.08);
  ASSERT_EQ(width.bins.size(), 6u);
  int num_observations = 0;
  for (const WidthBin& bin : width.bins) {
    num_observations += bin.num_observations;
    const double middle_m = 0.5 * (bin.range_min_m + bin.range_max_m);
    EXPECT_NEAR(bin.mean_m, 0.12, 0.002);
    EXPECT_NEAR(bin.sd_m, std::hypot(0.010, 0.8 * middle_m * kStep_rad), 0.0015);
  }
  EXPECT_EQ(num_observations, 3000);
}

// A trunk that was not among the examples: its widths scatter as much as is said, however few
// trunks said so. The trunks scatter by 15 mm, the scanner's beams by 0.8 steps.
TEST(WidthByRange, FewTrunksTellWhatAnotherOneScatters) {
  constexpr int kSeeds = 2000, kTrunks = 6, kObservations = 20;
  double z2 = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    std::mt19937_64 random(static_cast<unsigned>(seed));
    std::vector<WidthObservation> observations;
    double mean_m = 0.0;
    const auto observe = [&](double trunk_m, int i) {
      const double range_m = 1.0 + 5.0 * i / kObservations;
      return WidthObservation{range_m, kStep_rad,
                              trunk_m + 0.8 * range_m * kStep_rad * normal(random)};
    };
    for (int trunk = 0; trunk < kTrunks; ++trunk) {
      const double trunk_m = 0.12 + 0.015 * normal(random);
      for (int i = 0; i < kObservations; ++i) {
        observations.push_back(observe(trunk_m, i));
        observations.back().trunk = trunk;
        mean_m += observations.back().width_m / (kTrunks * kObservations);
      }
    }
    const WidthByRange width = width_by_range(observations);
    const WidthObservation other = observe(0.12 + 0.015 * normal(random), seed % kObservations);
    const double off_m = other.width_m - mean_m;
    z2 += off_m * off_m /
          (width.sd_m * width.sd_m +
           std::pow(width.sd_per_beam_step * other.range_m * kStep_rad, 2.0)) /
          kSeeds;
  }
  EXPECT_NEAR(z2, 1.0, 0.2);
}

TEST(WidthByRange, NeitherPartIsEverNegative) {
  EXPECT_EQ(width_by_range(observations_with(0.0, 0.8, 6.0, 600)).has_growth, true);
  EXPECT_LT(width_by_range(observations_with(0.0, 0.8, 6.0, 600)).sd_m, 0.003);
  const WidthByRange flat = width_by_range(observations_with(0.010, 0.0, 6.0, 600));
  EXPECT_NEAR(flat.sd_m, 0.010, 0.001);
  EXPECT_LT(flat.sd_per_beam_step, 0.25);
  // Scatter that falls with range is no growth.
  std::vector<WidthObservation> falling = observations_with(0.010, 0.0, 6.0, 600);
  for (WidthObservation& observation : falling)
    observation.width_m = 0.12 + (observation.width_m - 0.12) / observation.range_m;
  EXPECT_EQ(width_by_range(falling).sd_per_beam_step, 0.0);
}

TEST(WidthByRange, OneRangeTellsNothingOfGrowth) {
  const WidthByRange width = width_by_range(observations_with(0.010, 0.8, 1.2, 600));
  EXPECT_FALSE(width.has_growth);
  EXPECT_NEAR(width.sd_m, 0.010, 0.001);
  EXPECT_FALSE(width_by_range(observations_with(0.010, 0.8, 6.0, 20)).has_growth);
  EXPECT_TRUE(width_by_range({}).bins.empty());
}

}  // namespace
}  // namespace orchard::calibration
