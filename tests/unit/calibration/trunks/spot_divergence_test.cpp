// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/spot_divergence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace orchard::calibration {
namespace {

constexpr double kStep_rad = 0.00436;

/// Counts of beams, each at a phase of its own, of trunks that a diverging beam makes wider; those
/// of fewer than `min_beams` were never handed over.
std::vector<SpotWidth> observations_with(double divergence_rad, int min_beams, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<SpotWidth> observations;
  for (int thing = 0; thing < 20; ++thing) {
    const double width_m = 0.10 + 0.002 * thing;
    for (int i = 0; i < 60; ++i) {
      const double range_m = 1.0 + 0.1 * i, beam_m = range_m * kStep_rad;
      const double phase = static_cast<double>(random() >> 11) * 0x1p-53;
      const double beams = std::floor((width_m + divergence_rad * range_m) / beam_m + phase);
      if (beams < min_beams) continue;
      observations.push_back({thing, range_m, kStep_rad, beams * beam_m});
    }
  }
  return observations;
}

TEST(SpotDivergence, IsTheDivergenceWithinItsStandardError) {
  for (const double divergence_rad : {0.0, 0.002, 0.006}) {
    double squares = 0.0;
    constexpr int kSeeds = 40;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const auto growth = fit_spot_divergence(observations_with(divergence_rad, 4, seed), 4);
      ASSERT_TRUE(growth);
      EXPECT_LT(growth->se_rad, 0.001);
      squares += std::pow((growth->divergence_rad - divergence_rad) / growth->se_rad, 2) / kSeeds;
      EXPECT_EQ(growth->significant(), std::abs(growth->divergence_rad) > 3.0 * growth->se_rad);
      EXPECT_TRUE(growth->significant() || divergence_rad < 0.006);
    }
    EXPECT_LT(squares, 2.5) << divergence_rad;
  }
}

TEST(SpotDivergence, NeedsSeveralTrunksAtSeveralRanges) {
  EXPECT_FALSE(fit_spot_divergence({}, 4));
  EXPECT_FALSE(fit_spot_divergence({{0, 1.0, kStep_rad, 0.1}, {0, 2.0, kStep_rad, 0.1}}, 4));
  std::vector<SpotWidth> alike;
  for (int i = 0; i < 30; ++i) alike.push_back({i % 10, 2.0, kStep_rad, 0.1});
  EXPECT_FALSE(fit_spot_divergence(alike, 4));
}

}  // namespace
}  // namespace orchard::calibration
