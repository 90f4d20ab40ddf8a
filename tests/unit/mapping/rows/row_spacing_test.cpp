// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_spacing.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace orchard::mapping {
namespace {

constexpr double kSpacing_m = 2.25;
constexpr int kPlants = 25;

double uniform(std::mt19937_64& random, double a, double b) {
  return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A row whose steps differ by up to an eighth and add up, a tenth of its plants missing; `shoots`
/// around each plant, and stakes midway behind one in `stake_every`.
std::vector<double> row(std::mt19937_64& random, int shoots, std::uint64_t stake_every) {
  std::vector<double> along_m;
  double plant_m = 0.0;
  for (int k = 0; k < kPlants; ++k) {
    if (random() % 10 != 0) {
      along_m.push_back(plant_m);
      for (int s = 0; s < shoots; ++s) along_m.push_back(plant_m + uniform(random, -0.4, 0.4));
    }
    const double step_m = kSpacing_m * uniform(random, 0.875, 1.125);
    if (random() % stake_every == 0) along_m.push_back(plant_m + 0.5 * step_m);
    plant_m += step_m;
  }
  std::sort(along_m.begin(), along_m.end());
  return along_m;
}

double spacing_m(std::uint64_t seed, int shoots, std::uint64_t stake_every) {
  std::mt19937_64 random(seed);
  SpacingSpectrum spectrum;
  for (int r = 0; r < 6; ++r) spectrum.add(row(random, shoots, stake_every));
  return spectrum.strongest_m();
}

TEST(SpacingSpectrum, FindsThePlantingAmidShootsAndStakes) {
  constexpr std::uint64_t kNoStakes = 1'000'000;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const int shoots : {0, 2}) {
      for (const std::uint64_t stake_every : {kNoStakes, std::uint64_t{4}}) {
        EXPECT_NEAR(spacing_m(seed, shoots, stake_every), kSpacing_m, 0.1 * kSpacing_m)
            << "seed " << seed << ", shoots " << shoots << ", stakes " << stake_every;
      }
    }
  }
}

TEST(SpacingSpectrum, StakesBehindEveryPlantHalveIt) {
  EXPECT_NEAR(spacing_m(1, 0, 1), 0.5 * kSpacing_m, 0.1 * kSpacing_m);
}

TEST(SpacingSpectrum, KnowsNothingOfFewPlaces) {
  SpacingSpectrum spectrum;
  EXPECT_EQ(spectrum.strongest_m(), 0.0);
  spectrum.add(std::vector<double>{});
  spectrum.add(std::vector<double>{3.0});
  EXPECT_EQ(spectrum.strongest_m(), 0.0);
}

}  // namespace
}  // namespace orchard::mapping
