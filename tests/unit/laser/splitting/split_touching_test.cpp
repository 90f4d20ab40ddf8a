// SPDX-License-Identifier: BSD-3-Clause
// What touches: stems beside and behind each other, stakes, blades, flat things. Truth is the
// geometry the rays were cast at; fractions of seeds, with noise a scanner of the field has.
#include <gtest/gtest.h>

#include <algorithm>

#include "laser/segment.hpp"
#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::field_scanner;
using test::Noise;
using test::noisy_scan;
using test::Things;

constexpr int kSeeds = 200;

std::vector<Segment> segments_of(const Scan& scan, int min_beams = 2) {
  LaserConfig laser;
  laser.range_sd_m = 0.008;
  laser.range_sd_fraction = 0.0;
  SegmentationConfig config;
  config.min_beams = min_beams;
  return segment(scan, config, {}, laser);
}

/// Of which the circle or, lacking one, the middle of the front lies within a distance.
const Segment* at(const std::vector<Segment>& found, const Disc& disc, double within_m) {
  for (const Segment& s : found) {
    const double radius_m = 0.5 * s.width_m;
    const double x_m = s.circle ? s.circle->x_m : (s.range_m + radius_m) * std::cos(s.bearing_rad);
    const double y_m = s.circle ? s.circle->y_m : (s.range_m + radius_m) * std::sin(s.bearing_rad);
    if (std::hypot(x_m - disc.x_m, y_m - disc.y_m) < within_m) return &s;
  }
  return nullptr;
}

/// Of one tree's stems the farther one stands somewhere beside and behind, and touches the nearer.
struct Pair {
  Disc near, far;
};
Pair random_pair(Noise& noise, double behind_m) {
  const double range_m = 1.5 + 1.5 * noise.uniform();
  const double near_m = 0.055 + 0.015 * noise.uniform(), far_m = 0.055 + 0.015 * noise.uniform();
  const double apart_m = near_m + far_m + 0.003;
  const double across_m = std::sqrt(apart_m * apart_m - behind_m * behind_m);
  return {{range_m, 0.0, near_m}, {range_m + behind_m, across_m, far_m}};
}

TEST(Split, StemsSideBySideAreTwo) {
  int num_two = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Noise noise(seed);
    const Pair pair = random_pair(noise, 0.04 * noise.uniform());
    const auto found = segments_of(noisy_scan({{pair.near, pair.far}, {}}, field_scanner(), noise));
    const bool two = found.size() == 2 && at(found, pair.near, 0.03) && at(found, pair.far, 0.03);
    num_two += two ? 1 : 0;
  }
  EXPECT_GE(num_two, 190);
}

// No range between them is farther than both: only that one circle fits neither tells.
TEST(Split, AStemHalfBehindAnotherIsTwoAndItsSideIsHidden) {
  int num_two = 0, num_hidden = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Noise noise(seed);
    const Pair pair = random_pair(noise, 0.06 + 0.03 * noise.uniform());
    const auto found = segments_of(noisy_scan({{pair.near, pair.far}, {}}, field_scanner(), noise));
    const Segment *near = at(found, pair.near, 0.03), *far = at(found, pair.far, 0.05);
    if (found.size() != 2 || !near || !far) continue;
    ++num_two;
    EXPECT_FALSE(near->occluded_left) << seed;
    num_hidden += far->occluded_right ? 1 : 0;
  }
  EXPECT_GE(num_two, 190);
  EXPECT_GE(num_hidden, num_two * 9 / 10);
}

TEST(Split, AStakeThatTouchesATrunkDoesNotWidenIt) {
  int num_right = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Noise noise(seed);
    const double range_m = 2.0 + 1.5 * noise.uniform();
    const Disc trunk{range_m, 0.0, 0.062};
    const double side = noise.uniform() < 0.5 ? 1.0 : -1.0;
    const Disc stake{range_m - 0.08 + 0.16 * noise.uniform(), side * 0.082, 0.015};
    const auto found = segments_of(noisy_scan({{trunk, stake}, {}}, field_scanner(), noise));
    const Segment* s = at(found, trunk, 0.04);
    num_right += s && std::abs(s->width_m - 0.124) < 3.0 * std::hypot(s->width_sd_m, 0.008) ? 1 : 0;
  }
  EXPECT_GE(num_right, 130);  // one that stands beside and behind is like a wide trunk's border
}

// Nearer than a trunk by less than the step that separates objects, so that the cut does not see
// it.
// Something hides one side of a trunk, and noise makes what shows flat or even hollow: no pair.
TEST(Split, AHalfHiddenTrunkStaysOne) {
  int num_one = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Noise noise(seed);
    const Disc trunk{3.0, 0.0, 0.07};
    const Things things{{trunk}, {{1.5, 0.01 * noise.uniform(), 1.5, 0.6}}};
    const auto found = segments_of(noisy_scan(things, field_scanner(), noise), 1);
    num_one += std::count_if(found.begin(), found.end(),
                             [](const Segment& s) { return s.range_m > 2.5; }) == 1;
  }
  EXPECT_GE(num_one, 198);
}

// The noise of a range is known: what it makes of a whole trunk is never worth a second circle.
TEST(Split, AWholeTrunkHasACircleAndStaysOne) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    Noise noise(seed);
    const double radius_m = 0.04 + 0.12 * noise.uniform();
    const Disc trunk{0.5 + 4.0 * noise.uniform() + radius_m, 0.0, radius_m};
    const auto found = segments_of(noisy_scan({{trunk}, {}}, field_scanner(), noise), 1);
    ASSERT_EQ(found.size(), 1u) << seed;
    EXPECT_TRUE(found[0].circle) << seed;
  }
}

TEST(Split, ABoardIsNoPairOfTrunks) {
  int num_whole = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Noise noise(seed);
    const double half_m = 0.10 + 0.15 * noise.uniform(), slant_m = 0.2 * (noise.uniform() - 0.5);
    const Things board{{}, {{2.5 - slant_m, -half_m, 2.5 + slant_m, half_m}}};
    num_whole += segments_of(noisy_scan(board, field_scanner(), noise)).size() == 1;
  }
  EXPECT_GE(num_whole, 195);
}

TEST(Split, StaysAwayWhereItIsToldTo) {
  Noise noise(3);
  const Pair pair = random_pair(noise, 0.02);
  SegmentationConfig config;
  config.split_touching = false;
  const Scan scan = noisy_scan({{pair.near, pair.far}, {}}, field_scanner(), noise);
  EXPECT_EQ(segment(scan, config, {}).size(), 1u);
}

}  // namespace
}  // namespace orchard::laser
