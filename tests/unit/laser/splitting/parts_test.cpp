// SPDX-License-Identifier: BSD-3-Clause
// The steps of splitting, each by itself: on scans of discs and walls whose beams are counted.
#include <gtest/gtest.h>

#include "laser/splitting/best_split.hpp"
#include "laser/splitting/bright_cut.hpp"
#include "laser/splitting/candidate_parts.hpp"
#include "laser/splitting/line_fit.hpp"
#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::exact_scan;
using test::field_scanner;
using test::Things;

LaserConfig quiet() {
  LaserConfig laser;
  laser.range_sd_m = 0.008;
  laser.range_sd_fraction = 0.0;
  return laser;
}

/// A scan with what splitting needs of it.
struct Seen {
  explicit Seen(Scan of, SegmentationConfig with = {}) : scan(std::move(of)), config(with) {}

  Scan scan;
  SegmentationConfig config;
  LaserConfig laser = quiet();
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
                                quiet().range_sd_m, whole.num_beams);
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

}  // namespace
}  // namespace orchard::laser
