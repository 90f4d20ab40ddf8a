// SPDX-License-Identifier: BSD-3-Clause
// What real scans show besides whole trunks: grass, hidden sides, touching trunks, bushes, walls,
// poles of one beam, odd scanners, reflectors. Truth is the geometry the rays were cast at.
#include <gtest/gtest.h>

#include <algorithm>

#include "laser/segment.hpp"
#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::exact_scan;
using test::kPi;
using test::Noise;
using test::noisy_scan;
using test::Scanner;
using test::Things;
using test::urg;

LaserConfig noise_of(const Scanner& scanner) {
  LaserConfig laser;
  laser.range_sd_m = std::max(scanner.range_sd_m, 0.003);
  laser.range_sd_fraction = scanner.range_sd_fraction;
  return laser;
}

std::vector<Segment> segments_of(const Scan& scan, SegmentationConfig config = {}) {
  return segment(scan, config, {}, noise_of(urg()));
}

/// The segments whose surface is within 0.3 m of a range.
std::vector<Segment> around(const std::vector<Segment>& segments, double range_m) {
  std::vector<Segment> found;
  std::copy_if(segments.begin(), segments.end(), std::back_inserter(found),
               [&](const Segment& s) { return std::abs(s.range_m - range_m) < 0.3; });
  return found;
}

void expect_circle(const Segment& s, const Disc& truth, double tolerance_m) {
  ASSERT_TRUE(s.circle.has_value());
  EXPECT_NEAR(s.circle->x_m, truth.x_m, tolerance_m);
  EXPECT_NEAR(s.circle->y_m, truth.y_m, tolerance_m);
  EXPECT_NEAR(s.circle->radius_m, truth.radius_m, tolerance_m);
}

/// A wall nearer than everything that hides what lies left of a bearing.
test::Wall screen(double range_m, double from_rad, double to_rad) {
  return {range_m * std::cos(from_rad), range_m * std::sin(from_rad), range_m * std::cos(to_rad),
          range_m * std::sin(to_rad)};
}

TEST(RealScan, HalfATrunkHasTheCircleOfTheWhole) {
  const Disc trunk{1.5, 0.2, 0.115};
  const double axis_rad = std::atan2(trunk.y_m, trunk.x_m);
  for (const bool left : {true, false}) {
    const Things things{{trunk}, {screen(0.8, axis_rad, axis_rad + (left ? 0.4 : -0.4))}};
    const auto found = around(segments_of(exact_scan(things, urg())), 1.4);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].occluded_left, left);
    EXPECT_EQ(found[0].occluded_right, !left);
    // rays a beam step apart: the side that shows is known to half a step (4 mm)
    expect_circle(found[0], trunk, 0.012);
    EXPECT_NEAR(found[0].visible_fraction, 0.5, 0.08);
    EXPECT_NEAR(found[0].width_m, 0.23, 2.0 * found[0].width_sd_m);
    EXPECT_GT(found[0].width_sd_m, 0.01);
    EXPECT_LT(found[0].width_sd_m, 0.05);
  }
}

TEST(RealScan, TheMiddleOfATrunkSaysLittleOfItsWidthAndSaysSo) {
  const Disc trunk{1.5, 0.0, 0.115};
  const Things things{{trunk}, {screen(0.8, 0.03, 0.4), screen(0.8, -0.03, -0.4)}};
  const auto found = around(segments_of(exact_scan(things, urg())), 1.4);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].occluded_left);
  EXPECT_TRUE(found[0].occluded_right);
  if (found[0].circle) {
    EXPECT_GT(found[0].width_sd_m, 0.05);
  }
}

TEST(RealScan, ACircleThatMostBeamsMissIsNotTheObject) {
  // A face 0.5 m wide that recedes, its far end hidden: a small circle at its near end fits a few
  // beams, and the others, which miss it, do not contradict the fit.
  Scanner scanner = test::field_scanner();
  scanner.range_sd_m = 0.012;
  for (const double slant : {0.4, 0.6, 0.8}) {
    const test::Wall face{5.0, 0.0, 5.0 + 0.6 * slant, 0.6};
    const Things things{{}, {face, screen(3.0, 0.1, 0.5)}};
    for (int seed = 0; seed < 40; ++seed) {
      Noise noise(static_cast<std::uint64_t>(seed));
      const auto found = segment(noisy_scan(things, scanner, noise), {}, {}, noise_of(scanner));
      for (const Segment& s : found) {
        if (s.range_m < 4.5 || s.num_beams < 15) continue;
        EXPECT_GT(s.width_m, 0.4) << slant << " " << seed;
      }
    }
  }
}

TEST(RealScan, TheEndsOfAScanHideWhatLiesBeyond) {
  Scanner narrow = urg();
  narrow.num_beams = 201;  // +-35 degrees
  const double end_rad = 100.0 * narrow.step_rad;
  for (const double side : {1.0, -1.0}) {
    const Disc trunk{2.0 * std::cos(side * end_rad), 2.0 * std::sin(side * end_rad), 0.12};
    const auto found = segments_of(exact_scan({{trunk}, {}}, narrow));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].occluded_left, side > 0.0);
    EXPECT_EQ(found[0].occluded_right, side < 0.0);
  }
}

TEST(RealScan, ATwigPartsATrunkAndHidesTheSidesBesideIt) {
  const Disc trunk{2.0, 0.1, 0.12}, twig{1.2, 0.06, 0.010};
  const auto found = around(segments_of(exact_scan({{trunk, twig}, {}}, urg())), 1.9);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_TRUE(found[0].occluded_left);
  EXPECT_FALSE(found[0].occluded_right);
  EXPECT_TRUE(found[1].occluded_right);
  EXPECT_FALSE(found[1].occluded_left);
}

TEST(RealScan, ABladeAtTheBorderHidesThatSide) {
  const Disc trunk{2.0, 0.0, 0.12};
  const Disc blade{1.2, 1.2 * 0.058, 0.007};
  const auto found = around(segments_of(exact_scan({{trunk, blade}, {}}, urg())), 1.9);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_TRUE(found[0].occluded_left);
  EXPECT_FALSE(found[0].occluded_right);
}

TEST(RealScan, TwoTrunksBehindAPostStayTwo) {
  const Things things{{{3.0, 0.10, 0.05}, {3.0, -0.10, 0.05}, {1.5, 0.0, 0.03}}, {}};
  EXPECT_EQ(around(segments_of(exact_scan(things, urg())), 2.95).size(), 2u);
}

TEST(RealScan, TouchingTrunksAreTwo) {
  Noise noise(11);
  for (const double range_m : {1.0, 1.5, 2.0}) {
    const Disc left{range_m, 0.10, 0.10}, right{range_m, -0.10, 0.10};
    const auto found = segments_of(noisy_scan({{left, right}, {}}, urg(), noise));
    ASSERT_EQ(found.size(), 2u) << range_m;
    expect_circle(found[0], right, 0.02);
    expect_circle(found[1], left, 0.02);
  }
  SegmentationConfig config;
  config.split_touching = false;
  const Things things{{{1.5, 0.10, 0.10}, {1.5, -0.10, 0.10}}, {}};
  EXPECT_EQ(segments_of(exact_scan(things, urg()), config).size(), 1u);
}

// A blade of grass behind a gap is no part of the trunk.
TEST(RealScan, ABladeBeyondAGapIsNoPartOfTheTrunk) {
  const Disc trunk{2.0, 0.0, 0.06};
  const Disc in_front{1.2, 0.0475, 0.011};  // hides three beams beside the trunk
  const Disc beyond{2.03, 0.112, 0.006};    // one beam of what shows beyond it
  const auto found = around(segments_of(exact_scan({{trunk, in_front, beyond}, {}}, urg())), 1.95);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found[0].width_m, 0.16);
}

TEST(RealScan, ATrunkIsNeverSplit) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Noise noise(seed);
    const double range_m = 0.5 + 4.0 * noise.uniform(), radius_m = 0.04 + 0.12 * noise.uniform();
    const Things things{{{range_m + radius_m, 0.0, radius_m}}, {}};
    SegmentationConfig config;
    config.min_beams = 1;
    EXPECT_EQ(segments_of(noisy_scan(things, urg(), noise), config).size(), 1u)
        << range_m << " " << radius_m;
  }
}

TEST(RealScan, SmoothThingsAreSmoothAndBushesAreRagged) {
  double smooth = 0.0, ragged = 0.0, straight = 0.0, round = 0.0;
  constexpr int kSeeds = 100;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    Noise noise(seed);
    Things bush;
    for (int i = 0; i < 60; ++i) {  // leaves over half a metre square
      bush.discs.push_back({2.0 + 0.4 * noise.uniform(), 0.5 * noise.uniform() - 0.25, 0.012});
    }
    SegmentationConfig wide;
    wide.jump_m = 0.5;
    const auto leaves = segments_of(noisy_scan(bush, urg(), noise), wide);
    const auto trunk = segments_of(noisy_scan({{{2.0, 0.0, 0.12}}, {}}, urg(), noise));
    const auto board = segments_of(noisy_scan({{}, {{2.0, -0.3, 2.0, 0.3}}}, urg(), noise));
    ASSERT_EQ(trunk.size(), 1u);
    ASSERT_EQ(board.size(), 1u);
    ASSERT_FALSE(leaves.empty());
    const auto widest = *std::max_element(
        leaves.begin(), leaves.end(),
        [](const Segment& a, const Segment& b) { return a.num_beams < b.num_beams; });
    ragged += widest.roughness / kSeeds;
    smooth += trunk[0].roughness / kSeeds;
    round += trunk[0].straightness / kSeeds;
    straight += board[0].straightness / kSeeds;
    EXPECT_LT(board[0].roughness, 2.0);
  }
  EXPECT_GT(smooth, 0.5);
  EXPECT_LT(smooth, 1.5);
  EXPECT_GT(ragged, 4.0);
  EXPECT_LT(round, 0.3);
  EXPECT_GT(straight, 0.9);
}

TEST(RealScan, APoleOfOneBeamIsAnObjectOfUnknownWidth) {
  SegmentationConfig config;
  config.min_beams = 1;
  config.range_max_m = 30.0;
  const Things pole{{{8.0, 0.0, 0.03}}, {}};
  const auto found = segments_of(exact_scan(pole, urg()), config);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].num_beams, 1);
  EXPECT_LT(std::abs(found[0].width_m - 0.06), 2.0 * found[0].width_sd_m);
  EXPECT_FALSE(found[0].circle.has_value());
  EXPECT_TRUE(segments_of(exact_scan(pole, urg())).empty());
}

TEST(RealScan, GapsReachToTheNextThing) {
  const Things things{{{2.0, 0.0, 0.05}, {2.0, 0.4, 0.05}}, {}};
  const auto found = segments_of(exact_scan(things, urg()));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NEAR(found[0].gap_left_m, 0.3, 0.03);
  EXPECT_NEAR(found[1].gap_right_m, 0.3, 0.03);
  EXPECT_EQ(found[0].gap_right_m, kGapMax_m);
}

TEST(RealScan, AnyStepFieldAndDirectionSeesTheSame) {
  const Disc trunk{-1.8, 0.6, 0.11};  // behind: across a full turn's seam at some starts
  for (const double step_deg : {0.1, 0.25, 0.36, 0.5, 1.0}) {
    for (const bool clockwise : {false, true}) {
      for (const double start_deg : {-180.0, 0.0, 161.5}) {
        Scanner scanner{step_deg * kPi / 180.0, static_cast<int>(std::lround(360.0 / step_deg))};
        Scan scan = scanner.empty();
        scan.bearing_min_rad = start_deg * kPi / 180.0;
        if (clockwise) scan.bearing_step_rad = -scan.bearing_step_rad;
        for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
          const double range_m =
              test::hit_m({{trunk}, {}}, scan.bearing_rad(static_cast<double>(i)));
          if (range_m < 30.0) scan.ranges_m[i] = static_cast<float>(range_m);
        }
        const auto found = segments_of(scan);
        ASSERT_EQ(found.size(), 1u) << step_deg << " " << clockwise << " " << start_deg;
        EXPECT_NEAR(found[0].width_m, 0.22, 2.5 * found[0].width_sd_m + 0.01);
        expect_circle(found[0], trunk, 0.004 + 0.25 * 1.9 * std::abs(scan.bearing_step_rad));
        EXPECT_FALSE(found[0].occluded_left || found[0].occluded_right);
      }
    }
  }
}

TEST(RealScan, CodesForNothingAreNothing) {
  const Disc trunk{2.0, 0.0, 0.10};
  const Scan clean = exact_scan({{trunk}, {}}, urg());
  const auto truth = segments_of(clean);
  ASSERT_EQ(truth.size(), 1u);
  for (const float code : {0.0f, 0.006f, 0.019f, std::numeric_limits<float>::infinity(),
                           -std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN(), -1.0f, 30.0f, 65.533f}) {
    Scan scan = clean;
    for (float& range_m : scan.ranges_m) {
      if (range_m == 0.0f) range_m = code;
    }
    const auto found = segments_of(scan);
    ASSERT_EQ(found.size(), 1u) << code;
    EXPECT_EQ(found[0].width_m, truth[0].width_m) << code;
    EXPECT_FALSE(found[0].occluded_left || found[0].occluded_right) << code;
  }
}

TEST(RealScan, TheFarthestRangeItselfMeansNothing) {
  SegmentationConfig config;
  config.min_beams = 1;
  config.range_max_m = 40.0;
  Scan scan = urg().empty();
  scan.ranges_m[100] = static_cast<float>(scan.range_max_m);
  EXPECT_TRUE(segments_of(scan, config).empty());
  scan.ranges_m[100] = static_cast<float>(scan.range_max_m - 0.1);
  EXPECT_EQ(segments_of(scan, config).size(), 1u);
}

TEST(RealScan, ReflectorsAreBright) {
  Scan scan = exact_scan({{{2.0, 0.0, 0.05}, {2.0, 0.5, 0.05}}, {}}, urg());
  SegmentationConfig config;
  config.reflectivity_min = 1000.0;
  for (const Segment& s : segments_of(scan, config)) EXPECT_FALSE(s.is_reflector);
  scan.intensities.assign(scan.ranges_m.size(), 200.0f);
  auto found = segments_of(scan, config);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_DOUBLE_EQ(found[0].intensity, 200.0);
  EXPECT_FALSE(found[0].is_reflector);
  scan.intensities[found[1].middle_beam] = 3000.0f;
  found = segments_of(scan, config);
  EXPECT_FALSE(found[0].is_reflector);
  EXPECT_TRUE(found[1].is_reflector);
  EXPECT_DOUBLE_EQ(found[1].intensity_max, 3000.0);
  EXPECT_GT(found[1].intensity, 200.0);
}

TEST(RealScan, BrightBeamsStandByThemselves) {
  // a pole of 7 cm with a reflector 4 cm before a wide board, nearer than what separates objects
  SegmentationConfig config;
  config.reflectivity_min = 1000.0;
  WidthConfig poles;
  poles.mean_m = 0.07;
  for (const double range_m : {1.5, 3.0, 4.5}) {
    const Disc pole{range_m, 0.0, 0.035};
    const double board_m = range_m + 0.08;
    const Things things{{pole}, {{board_m, -0.3, board_m, 0.3}}};
    Scan scan = exact_scan(things, urg());
    scan.intensities.assign(scan.ranges_m.size(), 200.0f);
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
      if (test::hit_m({{pole}, {}}, bearing_rad) < 30.0) scan.intensities[i] = 3000.0f;
    }
    config.reflector = ReflectorUse::kIgnored;
    for (const Segment& s : segment(scan, config, poles)) EXPECT_GT(s.width_m, 0.2) << range_m;
    config.reflector = ReflectorUse::kOnly;
    int num_bright = 0;
    for (const Segment& s : segment(scan, config, poles)) {
      if (!s.is_reflector) continue;
      ++num_bright;
      EXPECT_NEAR(s.bearing_rad, 0.0, 0.6 * urg().step_rad) << range_m;
      EXPECT_NEAR(s.width_m, 0.07, 2.0 * range_m * urg().step_rad) << range_m;
      EXPECT_NEAR(s.range_m, range_m - 0.035, 0.02) << range_m;
    }
    EXPECT_EQ(num_bright, 1) << range_m;
  }
  // a tag on a trunk is narrower than the trunk, which stays whole
  Scan scan = exact_scan({{{2.0, 0.0, 0.06}}, {}}, urg());
  scan.intensities.assign(scan.ranges_m.size(), 200.0f);
  WidthConfig trunks;
  trunks.mean_m = 0.12;
  const auto whole = segment(scan, config, trunks);
  ASSERT_EQ(whole.size(), 1u);
  scan.intensities[whole[0].middle_beam] = 3000.0f;
  const auto tagged = segment(scan, config, trunks);
  ASSERT_EQ(tagged.size(), 1u);
  EXPECT_TRUE(tagged[0].is_reflector);
  EXPECT_EQ(tagged[0].width_m, whole[0].width_m);
  // whoever asks more of a trunk's width gets the tag as an object of its own
  trunks.mean_m = 0.135;
  EXPECT_EQ(segment(scan, config, trunks).size(), 1u);
  EXPECT_GT(segment(scan, config, trunks, {}, 0.9).size(), 1u);
}

TEST(RealScan, ThePapersWidthStaysThePapers) {
  // eq. 8 from the two end beams alone, whatever circles and sides say
  WidthConfig paper;
  paper.mode = WidthMode::kPaper;
  const double axis_rad = 0.1;
  const Things things{{{1.5, 1.5 * std::tan(axis_rad), 0.115}, {3.0, -1.0, 0.05}},
                      {screen(0.8, axis_rad, 0.5)}};
  const Scan scan = exact_scan(things, urg());
  int num_checked = 0;
  for (const Segment& s : segment(scan, {}, paper)) {
    if (s.range_m < 1.0) continue;
    const double r1 = scan.ranges_m[s.first_beam], r2 = scan.ranges_m[s.last_beam];
    const double angle_rad =
        static_cast<double>(s.last_beam - s.first_beam) * scan.bearing_step_rad;
    EXPECT_NEAR(s.width_m, std::sqrt(r1 * r1 + r2 * r2 - 2.0 * r1 * r2 * std::cos(angle_rad)),
                1e-12);
    ++num_checked;
  }
  EXPECT_EQ(num_checked, 2);
}

/// Fraction of seeds whose 95 % ellipse contains the true centre.
double coverage(const Scanner& scanner, double hidden_fraction, int num_seeds, int& num_fitted) {
  int inside = 0;
  num_fitted = 0;
  for (int seed = 0; seed < num_seeds; ++seed) {
    Noise noise(static_cast<std::uint64_t>(seed) + 700);
    const double radius_m = 0.045 + 0.07 * noise.uniform();
    const double centre_m = 0.6 + 2.4 * noise.uniform();
    const double bearing_rad = 2.0 * noise.uniform() - 1.0;
    const Disc trunk{centre_m * std::cos(bearing_rad), centre_m * std::sin(bearing_rad), radius_m};
    Things things{{trunk}, {}};
    if (hidden_fraction > 0.0) {
      const double half_rad = std::asin(radius_m / centre_m);
      const double from_rad = bearing_rad + half_rad * (1.0 - 2.0 * hidden_fraction);
      things.walls.push_back(screen(0.5 * centre_m, from_rad, from_rad + 0.5));
    }
    for (const Segment& s :
         segment(noisy_scan(things, scanner, noise), {}, {}, noise_of(scanner))) {
      if (std::abs(s.range_m - centre_m) > 0.25 || !s.circle || s.range_m < 0.6 * centre_m)
        continue;
      const auto& [xx, xy, yy, xr, yr, rr] = s.circle->covariance;
      const double dx = s.circle->x_m - trunk.x_m, dy = s.circle->y_m - trunk.y_m;
      const double z2 = (dx * dx * yy - 2.0 * dx * dy * xy + dy * dy * xx) / (xx * yy - xy * xy);
      inside += z2 < 5.991;  // chi2 of two, 95 %
      ++num_fitted;
    }
  }
  return static_cast<double>(inside) / num_fitted;
}

// In 95 % of cases 500 draws hold the truth in 93.1 to 96.9 %. Of the nine here two are out of
// that: 98.0 % (0.0044 rad, whole trunk: stated too large), 92.6 % of 431 (0.0070 rad, hidden by
// 0.3).
TEST(CircleFit, NinetyToNinetyEightPercentOfItsEllipsesHoldTheTruth) {
  constexpr int kSeeds = 500;
  for (const Scanner& scanner : {urg(), test::field_scanner(), test::vlp16_slice()}) {
    for (const double hidden : {0.0, 0.3, 0.5}) {
      int num_fitted = 0;
      const double fraction = coverage(scanner, hidden, kSeeds, num_fitted);
      // With a hidden side the radius follows from the curvature alone, which a linear covariance
      // understates for few beams: 0.912 of 410 at 0.4 degrees.
      EXPECT_GT(fraction, hidden > 0.0 ? 0.90 : 0.92) << scanner.step_rad << " " << hidden;
      EXPECT_LT(fraction, 0.985) << scanner.step_rad << " " << hidden;
      EXPECT_GT(num_fitted, hidden > 0.0 ? kSeeds / 2 : kSeeds * 9 / 10) << hidden;
      RecordProperty("coverage", std::to_string(fraction));
      std::printf("  step %.4f rad, hidden %.1f: %.3f of %d\n", scanner.step_rad, hidden, fraction,
                  num_fitted);
    }
  }
}

}  // namespace
}  // namespace orchard::laser
