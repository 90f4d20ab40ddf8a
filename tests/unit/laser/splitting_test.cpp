// SPDX-License-Identifier: BSD-3-Clause
// Splitting: its steps, each by itself, on scans of discs and walls whose beams are counted; then
// what touches: stems beside and behind each other, stakes, flat things. Truth is the geometry the
// rays were cast at; fractions of seeds, with the noise of a scanner in the field.
#include "laser/splitting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "laser/segment.hpp"
#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::exact_scan;
using test::field_scanner;
using test::Noise;
using test::noise_of;
using test::noisy_scan;
using test::Scanner;
using test::Things;

/// A scan with what splitting needs of it.
struct Seen {
  explicit Seen(Scan of, SegmentationConfig with = {}) : scan(std::move(of)), config(with) {}

  Scan scan;
  SegmentationConfig config;
  LaserConfig laser = noise_of(field_scanner());
  Beams beams{scan, config};
  CandidateFitter fit{beams, config, laser};
  std::vector<Candidate> candidates = find_candidates(beams);
};

Scan scan_of(const Things& things) { return exact_scan(things, field_scanner()); }

TEST(CandidateParts, ShareTheBeamsAndKnowWhereTheyTouch) {
  Seen seen(scan_of({{{2.0, 0.0, 0.1}}, {}}));
  ASSERT_EQ(seen.candidates.size(), 1u);
  Candidate whole = seen.candidates[0];
  whole.hidden_before = true;
  const Split split = split_at(seen.beams, whole, whole.first + 8);
  EXPECT_EQ(split.before.first, whole.first);
  EXPECT_EQ(split.before.last, whole.first + 8);
  EXPECT_EQ(split.after.first, whole.first + 9);
  EXPECT_EQ(split.after.last, whole.last);
  EXPECT_EQ(split.before.num_beams, 9);
  EXPECT_EQ(split.before.num_beams + split.after.num_beams, whole.num_beams);
  EXPECT_TRUE(split.before.hidden_before && split.before.touches_after);
  EXPECT_TRUE(split.after.touches_before && !split.after.hidden_before);
}

TEST(CandidateParts, TheFartherOfTwoContinuesBehindTheNearer) {
  // Stems of 12 cm, the left one 8 cm farther: more than three quarters of a radius.
  const Disc near{2.0, -0.06, 0.06}, far{2.08, 0.03, 0.06};
  Seen seen(scan_of({{near, far}, {}}));
  ASSERT_EQ(seen.candidates.size(), 1u);
  const Candidate& whole = seen.candidates[0];
  std::ptrdiff_t border = whole.first;
  while (test::hit_m({{near}, {}}, seen.scan.bearing_rad(static_cast<double>(border + 1))) < 3.0) {
    ++border;
  }
  Split split = split_at(seen.beams, whole, border);
  order_by_depth(split.before, split.after, seen.fit);
  EXPECT_TRUE(split.after.hidden_before);
  EXPECT_FALSE(split.before.touches_after);

  // Side by side, neither hides the other.
  Seen level(scan_of({{{2.0, -0.06, 0.06}, {2.0, 0.06, 0.06}}, {}}));
  ASSERT_EQ(level.candidates.size(), 1u);
  Split halves = split_at(level.beams, level.candidates[0],
                          (level.candidates[0].first + level.candidates[0].last) / 2);
  order_by_depth(halves.before, halves.after, level.fit);
  EXPECT_FALSE(halves.after.hidden_before || halves.before.hidden_after);
}

TEST(BestSplit, CutsAPairWhereItsStemsTouchAndLeavesOneStemWhole) {
  const auto parts_of = [](const Things& things, double span_m) {
    Seen seen(scan_of(things));
    EXPECT_EQ(seen.candidates.size(), 1u);
    const Candidate& whole = seen.candidates[0];
    const PartEvidence evidence(WidthConfig{}, seen.config, 2.0 * seen.beams.step_rad(), span_m,
                                noise_of(field_scanner()).range_sd_m, whole.num_beams);
    BestSplit split(seen.beams, seen.fit);
    std::vector<double> bearings_rad;
    for (const Candidate& part : split(whole, evidence)) {
      bearings_rad.push_back(
          seen.scan.bearing_rad(0.5 * static_cast<double>(part.first + part.last)));
    }
    return bearings_rad;
  };
  const std::vector<double> two = parts_of({{{2.0, -0.045, 0.045}, {2.0, 0.045, 0.045}}, {}}, 0.18);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_NEAR(two[0], -0.0225, 0.005);
  EXPECT_NEAR(two[1], 0.0225, 0.005);
  EXPECT_TRUE(parts_of({{{2.0, 0.0, 0.045}}, {}}, 0.09).empty());
  EXPECT_TRUE(parts_of({{{2.0, 0.0, 0.09}}, {}}, 0.18).empty());
}

TEST(PartEvidence, ATrunksWidthIsLikelierThanAnotherAndTwoStemsAreSeldom) {
  const WidthConfig width;
  const PartEvidence evidence(width, SegmentationConfig{}, 0.01, 0.18, 0.008, 20);
  CircleFit circle;
  circle.dof = 17;
  circle.chi2 = 20.0;
  circle.covariance[5] = 1e-6;
  const auto cost = [&](double width_m) {
    circle.radius_m = 0.5 * width_m;
    return evidence.of_circle(circle, Candidate{});
  };
  EXPECT_LT(cost(width.mean_m), cost(width.mean_m + 3.0 * width.sd_m));
  EXPECT_LT(cost(width.mean_m + 3.0 * width.sd_m), cost(width.mean_m + 10.0 * width.sd_m));
  // Far off the trunks' widths only the even density is left: half of 1 / width_max.
  EXPECT_NEAR(cost(0.5), -2.0 * std::log(0.5 / 2.0 * 0.01), 1e-9);
  // What measurements speak above their number, they cost.
  const double at_mean = cost(width.mean_m);
  circle.chi2 += 7.0;
  EXPECT_NEAR(cost(width.mean_m) - at_mean, 7.0, 1e-12);
  // A pair is one thing in fifty, and lies somewhere in depth.
  EXPECT_GE(evidence.of_second_circle(), -2.0 * std::log(0.02));
  EXPECT_EQ(evidence.radius_prior().mean_m, 0.5 * width.mean_m);
}

TEST(LineFit, ChiSquareIsZeroOnAWallAndThatOfItsNoise) {
  Arc arc;
  const double sd_m = 0.01;
  for (int i = 0; i < 40; ++i) {
    const double bearing_rad = -0.2 + 0.01 * i;
    arc.cosines.push_back(std::cos(bearing_rad));
    arc.sines.push_back(std::sin(bearing_rad));
    // The wall x + 0.5 y = 3.
    arc.ranges_m.push_back(3.0 / (std::cos(bearing_rad) + 0.5 * std::sin(bearing_rad)));
  }
  EXPECT_NEAR(line_chi2(arc, sd_m), 0.0, 1e-6);
  test::Noise noise(3);
  double sum = 0.0;
  constexpr int kSeeds = 200;
  for (int k = 0; k < kSeeds; ++k) {
    Arc noisy = arc;
    for (double& range_m : noisy.ranges_m) range_m += sd_m * noise.normal();
    sum += line_chi2(noisy, sd_m);
  }
  // Mean 38 of variance 2 x 38 / 200: three standard deviations.
  EXPECT_NEAR(sum / kSeeds, 38.0, 3.0 * std::sqrt(2.0 * 38.0 / kSeeds));
}

TEST(CutAtBright, AReflectorStandsByItselfUnlessATrunkWearsIt) {
  Scan scan = scan_of({{{2.0, 0.0, 0.12}}, {}});
  scan.intensities.assign(scan.ranges_m.size(), 100.0f);
  for (const std::size_t i : {541u, 542u, 544u}) scan.intensities[i] = 1000.0f;  // one dim between
  SegmentationConfig config;
  config.reflector = ReflectorUse::kExclude;
  config.reflectivity_min = 500.0;
  Seen seen(scan, config);
  ASSERT_EQ(seen.candidates.size(), 1u);
  std::vector<Candidate> whole = seen.candidates, cut = seen.candidates;
  cut_at_bright(seen.beams, whole, [](const Candidate&) { return true; });
  EXPECT_EQ(whole.size(), 1u);
  cut_at_bright(seen.beams, cut, [](const Candidate&) { return false; });
  ASSERT_EQ(cut.size(), 3u);
  const Candidate& bright = cut[2];
  EXPECT_TRUE(bright.is_bright && bright.touches_before && bright.touches_after);
  EXPECT_EQ(bright.first, 541);
  EXPECT_EQ(bright.last, 544);
  EXPECT_EQ(bright.num_beams, 3);
  EXPECT_EQ(cut[0].last, 540);
  EXPECT_EQ(cut[1].first, 545);
  EXPECT_EQ(cut[0].num_beams + cut[1].num_beams + 4, seen.candidates[0].num_beams);
}

std::vector<Segment> segments_of(const Things& things, Noise& noise, int min_beams = 2) {
  SegmentationConfig config;
  config.min_beams = min_beams;
  return segment(noisy_scan(things, field_scanner(), noise), config, {}, noise_of(field_scanner()));
}

/// Of `num` seeds, the number whose segments are as asked.
int count(int num, const std::function<bool(Noise&)>& is_right) {
  int num_right = 0;
  for (int seed = 0; seed < num; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed));
    num_right += is_right(noise) ? 1 : 0;
  }
  return num_right;
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
  const int num_two = count(200, [](Noise& noise) {
    const Pair pair = random_pair(noise, 0.04 * noise.uniform());
    const auto found = segments_of({{pair.near, pair.far}, {}}, noise);
    return found.size() == 2 && at(found, pair.near, 0.03) && at(found, pair.far, 0.03);
  });
  EXPECT_GE(num_two, 190);
}

// No range between them is farther than both: only that one circle fits neither tells.
TEST(Split, AStemHalfBehindAnotherIsTwoAndItsSideIsHidden) {
  int num_hidden = 0;
  const int num_two = count(200, [&](Noise& noise) {
    const Pair pair = random_pair(noise, 0.06 + 0.03 * noise.uniform());
    const auto found = segments_of({{pair.near, pair.far}, {}}, noise);
    const Segment *near = at(found, pair.near, 0.03), *far = at(found, pair.far, 0.05);
    if (found.size() != 2 || !near || !far) return false;
    EXPECT_FALSE(near->occluded_left);
    num_hidden += far->occluded_right ? 1 : 0;
    return true;
  });
  EXPECT_GE(num_two, 190);
  EXPECT_GE(num_hidden, num_two * 9 / 10);
}

TEST(Split, AStakeThatTouchesATrunkDoesNotWidenIt) {
  const int num_right = count(200, [](Noise& noise) {
    const double range_m = 2.0 + 1.5 * noise.uniform();
    const Disc trunk{range_m, 0.0, 0.062};
    const double side = noise.uniform() < 0.5 ? 1.0 : -1.0;
    const Disc stake{range_m - 0.08 + 0.16 * noise.uniform(), side * 0.082, 0.015};
    const auto found = segments_of({{trunk, stake}, {}}, noise);
    const Segment* s = at(found, trunk, 0.04);
    return s && std::abs(s->width_m - 0.124) < 3.0 * std::hypot(s->width_sd_m, 0.008);
  });
  EXPECT_GE(num_right, 130);  // one that stands beside and behind is like a wide trunk's border
}

// Something hides one side of a trunk, and noise makes what shows flat or even hollow: no pair.
TEST(Split, AHalfHiddenTrunkStaysOne) {
  const int num_one = count(200, [](Noise& noise) {
    const Things things{{{3.0, 0.0, 0.07}}, {{1.5, 0.01 * noise.uniform(), 1.5, 0.6}}};
    const auto found = segments_of(things, noise, 1);
    return std::count_if(found.begin(), found.end(),
                         [](const Segment& s) { return s.range_m > 2.5; }) == 1;
  });
  EXPECT_GE(num_one, 198);
}

// The noise of a range is known: what it makes of a whole trunk is never worth a second circle.
TEST(Split, AWholeTrunkHasACircleAndStaysOne) {
  const int num_one = count(500, [](Noise& noise) {
    const double radius_m = 0.04 + 0.12 * noise.uniform();
    const Disc trunk{0.5 + 4.0 * noise.uniform() + radius_m, 0.0, radius_m};
    const auto found = segments_of({{trunk}, {}}, noise, 1);
    return found.size() == 1 && found[0].circle;
  });
  EXPECT_EQ(num_one, 500);
}

TEST(Split, ABoardIsNoPairOfTrunks) {
  const int num_whole = count(200, [](Noise& noise) {
    const double half_m = 0.10 + 0.15 * noise.uniform(), slant_m = 0.2 * (noise.uniform() - 0.5);
    return segments_of({{}, {{2.5 - slant_m, -half_m, 2.5 + slant_m, half_m}}}, noise).size() == 1;
  });
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

// Two stems as wide as the trunks of the orchard, and what could pass for two: far off, with a
// scanner of 12 mm noise, where six beams meet each stem.
struct StemPairs : testing::Test {
  static constexpr int kSeeds = 400;

  static std::vector<Segment> far_segments(const Things& things, Noise& noise) {
    const Scanner scanner{0.25 * test::kPi / 180.0, 1081, 0.012, 0.0};
    WidthConfig trunks;
    trunks.mean_m = 0.120;
    trunks.sd_m = 0.015;
    return segment(noisy_scan(things, scanner, noise), {}, trunks, noise_of(scanner));
  }

  static double trunk_radius_m(Noise& noise) { return 0.5 * (0.120 + 0.015 * noise.normal()); }

  /// Two stems that nearly touch, the second one seen `turned_rad` behind the first.
  static Pair pair_at(Noise& noise, double turned_rad_min, double turned_rad_range) {
    const Disc near{3.0 + noise.uniform(), 0.0, trunk_radius_m(noise)};
    Disc far{0.0, 0.0, trunk_radius_m(noise)};
    const double apart_m = near.radius_m + far.radius_m + 0.01 * noise.uniform();
    const double turned_rad = turned_rad_min + turned_rad_range * noise.uniform();
    far.x_m = near.x_m + apart_m * std::sin(turned_rad);
    far.y_m = near.y_m + apart_m * std::cos(turned_rad);
    return {near, far};
  }

  static bool has(const std::vector<Segment>& found, const Disc& disc) {
    return std::any_of(found.begin(), found.end(), [&](const Segment& s) {
      const double to_axis_m = s.range_m + 0.5 * s.width_m;
      return std::hypot(to_axis_m * std::cos(s.bearing_rad) - disc.x_m,
                        to_axis_m * std::sin(s.bearing_rad) - disc.y_m) < 0.04 &&
             std::abs(s.width_m - 2.0 * disc.radius_m) < 0.04;
    });
  }
};

TEST_F(StemPairs, AreTwoAtThreeToFourMetres) {
  const int num_two = count(kSeeds, [](Noise& noise) {
    const Pair pair = pair_at(noise, -0.25, 0.5);
    const auto found = far_segments({{pair.near, pair.far}, {}}, noise);
    return found.size() == 2 && has(found, pair.near) && has(found, pair.far);
  });
  RecordProperty("two", num_two);
  EXPECT_GE(num_two, 360);
}

TEST_F(StemPairs, TheNearerStandsAloneWhereItHidesTheOther) {
  const int num_right = count(kSeeds, [](Noise& noise) {
    const Pair pair = pair_at(noise, 0.7, 0.3);
    return has(far_segments({{pair.near, pair.far}, {}}, noise), pair.near);
  });
  RecordProperty("right", num_right);
  EXPECT_GE(num_right, 384);
}

TEST_F(StemPairs, ABoardAsWideAsTwoStaysOne) {
  const int num_one = count(kSeeds, [](Noise& noise) {
    const double range_m = 3.0 + noise.uniform(), half_m = 0.10 + 0.05 * noise.uniform();
    const double slant_m = 0.1 * (noise.uniform() - 0.5);
    return far_segments({{}, {{range_m - slant_m, -half_m, range_m + slant_m, half_m}}}, noise)
               .size() == 1;
  });
  RecordProperty("one", num_one);
  EXPECT_GE(num_one, 368);
}

TEST_F(StemPairs, ATrunkStaysOneHoweverWide) {
  const int num_one = count(kSeeds, [](Noise& noise) {
    const double radius_m = 0.03 + 0.12 * noise.uniform();
    const Disc trunk{2.0 + 2.0 * noise.uniform(), 0.0, radius_m};
    return far_segments({{trunk}, {}}, noise).size() == 1;
  });
  RecordProperty("one", num_one);
  EXPECT_GE(num_one, 398);
}

}  // namespace
}  // namespace orchard::laser
