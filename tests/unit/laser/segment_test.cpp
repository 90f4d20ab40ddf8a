// SPDX-License-Identifier: BSD-3-Clause
// Segmentation and measurement, and what real scans show besides whole trunks: grass, hidden sides,
// bushes, walls, poles of one beam, odd scanners, reflectors. Truth is the geometry the rays were
// cast at.
#include "laser/segment.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::exact_scan;
using test::field_scanner;
using test::kPi;
using test::Noise;
using test::noise_of;
using test::noisy_scan;
using test::Scanner;
using test::screen;
using test::Things;
using test::urg;

/// What a URG of 5.6 m sees of discs.
Scan urg_scan(const std::vector<Disc>& discs = {}) {
  Scanner scanner = urg();
  scanner.range_max_m = 5.6;
  return exact_scan({discs, {}}, scanner);
}

double mean_width_m(double diameter_m, double range_m, WidthMode mode) {
  WidthConfig width;
  width.mode = mode;
  double sum = 0.0;
  int n = 0;
  for (double b = -1.5; b < 1.5; b += 0.0107) {
    Scan scan = urg_scan({{range_m * std::cos(b), range_m * std::sin(b), 0.5 * diameter_m}});
    const auto segments = segment(scan, {}, width);
    if (segments.size() != 1) ADD_FAILURE() << segments.size() << " objects at " << range_m;
    for (const Segment& s : segments) sum += s.width_m, ++n;
  }
  return sum / n;
}

TEST(Width, CompensatedIsUnbiasedForTubeAndTrunk) {
  for (double r = 0.5; r <= 4.0; r += 0.5) {
    EXPECT_NEAR(mean_width_m(0.090, r, WidthMode::kCompensated), 0.090, 0.03 * 0.090) << r;
    EXPECT_NEAR(mean_width_m(0.230, r, WidthMode::kCompensated), 0.230, 0.05 * 0.230) << r;
  }
}

// A beam that is a spot returns as soon as any of it meets something: then a thing is met by as
// many beams as one that is a spot wider.
TEST(Width, OfSpotsIsLessByTheSpot) {
  constexpr double kDiameter_m = 0.07, kStart_m = 0.008, kDivergence_rad = 0.004;
  LaserConfig laser;
  laser.spot_m = kStart_m;
  laser.spot_rad = kDivergence_rad;
  for (const double range_m : {1.0, 2.0, 3.0, 4.0}) {
    const double spot_m = kStart_m + kDivergence_rad * range_m;
    double sum_m = 0.0, line_sum_m = 0.0;
    int n = 0;
    for (double b = -1.5; b < 1.5; b += 0.0107) {
      const double radius_m = 0.5 * (kDiameter_m + spot_m);
      const Scan scan = urg_scan({{range_m * std::cos(b), range_m * std::sin(b), radius_m}});
      const auto segments = segment(scan, {}, {}, laser);
      const auto as_lines = segment(scan, {}, {});
      ASSERT_EQ(segments.size(), 1u);
      sum_m += segments[0].width_m;
      line_sum_m += as_lines[0].width_m;
      ++n;
    }
    EXPECT_NEAR(sum_m / n, kDiameter_m, 0.03 * kDiameter_m) << range_m;
    EXPECT_GT(line_sum_m / n, kDiameter_m + 0.8 * spot_m) << range_m;
  }
}

TEST(Width, ThePaperLosesABeam) {
  EXPECT_NEAR(mean_width_m(0.090, 0.5, WidthMode::kPaper) / 0.090, 0.94, 0.03);
  EXPECT_NEAR(mean_width_m(0.090, 4.0, WidthMode::kPaper) / 0.090, 0.73, 0.04);
}

TEST(Segment, OneMissingBeamIsBridgedTwoAreNot) {
  for (const float nothing : {0.0f, std::numeric_limits<float>::infinity(),
                              std::numeric_limits<float>::quiet_NaN(), 30.0f, -1.0f}) {
    Scan scan = urg_scan();
    for (std::size_t i = 300; i < 320; ++i) scan.ranges_m[i] = 2.0f;
    scan.ranges_m[310] = nothing;
    auto segments = segment(scan, {}, {});
    ASSERT_EQ(segments.size(), 1u);
    EXPECT_EQ(segments[0].num_beams, 19);
    EXPECT_EQ(segments[0].first_beam, 300u);
    EXPECT_EQ(segments[0].last_beam, 319u);
    scan.ranges_m[311] = nothing;
    EXPECT_EQ(segment(scan, {}, {}).size(), 2u);
  }
}

TEST(Segment, MixedPixelsNeitherWidenNorBridge) {
  Scan scan = urg_scan();
  for (std::size_t i = 300; i < 310; ++i) scan.ranges_m[i] = 2.0f;
  for (std::size_t i = 310; i < 325; ++i) scan.ranges_m[i] = 2.25f;
  const auto clean = segment(scan, {}, {});
  ASSERT_EQ(clean.size(), 2u);
  for (const float between : {2.06f, 2.12f, 2.2f}) {
    scan.ranges_m[310] = between;
    const auto mixed = segment(scan, {}, {});
    ASSERT_EQ(mixed.size(), 2u) << between;
    EXPECT_LE(mixed[0].last_beam, 310u);
    EXPECT_GE(mixed[1].first_beam, 310u);
  }
}

TEST(Segment, ATrunkBeforeFoliageComesOutWhole) {
  Scan scan = urg_scan({{2.0, 0.0, 0.10}});
  for (std::size_t i = 0; i < 683; ++i) {
    const float foliage = 3.0f + 0.4f * static_cast<float>((i * 7919) % 13) / 13.0f;
    if (scan.ranges_m[i] == 0.0f) scan.ranges_m[i] = foliage;
  }
  int num_trunks = 0;
  for (const Segment& s : segment(scan, {}, {})) {
    if (s.range_m > 2.5) continue;
    ++num_trunks;
    EXPECT_NEAR(s.width_m, 0.20, 0.02);
    EXPECT_NEAR(s.range_m, 1.90, 0.02);
    EXPECT_FALSE(s.occluded_left);
    EXPECT_FALSE(s.occluded_right);
  }
  EXPECT_EQ(num_trunks, 1);
}

TEST(Segment, WallsAreNotReportedAndNothingIsNothing) {
  Scan scan = urg_scan();
  EXPECT_TRUE(segment(scan, {}, {}).empty());
  scan.ranges_m.assign(683, 3.0f);
  EXPECT_TRUE(segment(scan, {}, {}).empty());
  EXPECT_TRUE(segment(Scan{}, {}, {}).empty());
}

TEST(Segment, TheBlindSectorIsBlind) {
  Scan scan = urg_scan({{2.0, 0.0, 0.05}, {2.0, 1.0, 0.05}});
  SegmentationConfig config;
  config.blind_half_width_rad = 0.2;
  const auto segments = segment(scan, config, {});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_GT(segments[0].bearing_rad, 0.3);
}

TEST(RocLaser, IsTheRatioOfDensities) {
  WidthConfig width;
  width.sd_per_beam_step = 0.0;
  const auto pdf = [&](double w) {  // eq. 9
    return std::exp(-std::pow(w - width.mean_m, 2) / (2.0 * width.sd_m * width.sd_m)) /
           (width.sd_m * std::sqrt(2.0 * kPi));
  };
  EXPECT_DOUBLE_EQ(roc_laser(0.105, 2.0, 0.006, width), pdf(0.105) / pdf(width.mean_m));
  EXPECT_LT(roc_laser(0.170, 4.0, 0.00614, WidthConfig{}), 0.001);
  width.sd_m = 0.0;
  EXPECT_GT(roc_laser(width.mean_m + WidthConfig::kSdFloor_m, 1.0, 0.006, width), 0.5);
}

/// Measures the candidate whose beams include the middle of the scan.
Segment measured(const Scan& scan, const WidthConfig& width = {}, const LaserConfig& laser = {},
                 const SegmentationConfig& config = {}) {
  const Beams beams(scan, config);
  CandidateFitter fit(beams, config, laser);
  for (const Candidate& candidate : find_candidates(beams)) {
    if (candidate.first > 540 || candidate.last < 540) continue;
    return measure(scan, beams, candidate, config, width, laser, fit);
  }
  ADD_FAILURE() << "nothing ahead";
  return {};
}

TEST(Measure, ATrunkAheadIsWhereItStandsAndAsWideAsItIs) {
  const Disc trunk{2.0, 0.0, 0.06};
  const Segment s = measured(exact_scan({{trunk}, {}}, field_scanner()));
  const double step_rad = field_scanner().step_rad;
  const double half_rad = std::asin(trunk.radius_m / trunk.x_m);
  // Edges are known to half a beam step.
  EXPECT_NEAR(s.bearing_rad, 0.0, 0.5 * step_rad);
  EXPECT_NEAR(s.start_bearing_rad, -half_rad, 0.5 * step_rad);
  EXPECT_NEAR(s.end_bearing_rad, half_rad, 0.5 * step_rad);
  EXPECT_NEAR(s.width_m, 2.0 * trunk.radius_m, 2.0 * step_rad * trunk.x_m);
  EXPECT_NEAR(s.range_m, trunk.x_m - trunk.radius_m, 0.003);
  EXPECT_EQ(s.num_beams, static_cast<int>(s.last_beam - s.first_beam) + 1);
  EXPECT_EQ(s.num_beams, 2 * static_cast<int>(half_rad / step_rad) + 1);
  ASSERT_TRUE(s.circle);
  EXPECT_NEAR(s.circle->x_m, trunk.x_m, 0.5 * step_rad * trunk.x_m + 1e-3);
  EXPECT_NEAR(s.circle->radius_m, trunk.radius_m, 0.5 * step_rad * trunk.x_m);
  EXPECT_LT(s.straightness, 0.1);
  EXPECT_FALSE(s.occluded_left || s.occluded_right);
  EXPECT_EQ(s.gap_left_m, kGapMax_m);
}

TEST(Measure, ABoardIsStraightAndAsWideAsItsChordHoweverItIsTurned) {
  for (const double turn_rad : {0.0, 0.5, -0.9}) {
    const double half_m = 0.15, dx = half_m * std::sin(turn_rad), dy = half_m * std::cos(turn_rad);
    const Segment s = measured(exact_scan({{}, {{2.0 - dx, -dy, 2.0 + dx, dy}}}, field_scanner()));
    EXPECT_NEAR(s.straightness, 1.0, 0.05) << turn_rad;
    EXPECT_NEAR(s.depth_m, 2.0 * std::abs(dx), 0.02) << turn_rad;
    EXPECT_LT(s.line_rms_m, 1e-4) << turn_rad;
    EXPECT_NEAR(s.width_m, 2.0 * half_m, 0.03) << turn_rad;
  }
}

TEST(Measure, ANearerThingHidesASideAndTheCircleTellsTheWidth) {
  const Disc trunk{2.0, 0.0, 0.10};
  // A wide board in front, to the left: bearings from 0.01 rad on.
  const Things things{{trunk}, {{1.0, 0.01, 1.0, 0.6}}};
  const Segment s = measured(exact_scan(things, field_scanner()));
  EXPECT_TRUE(s.occluded_left);
  EXPECT_FALSE(s.occluded_right);
  ASSERT_TRUE(s.circle);
  EXPECT_NEAR(s.width_m, 2.0 * s.circle->radius_m, 1e-12);
  EXPECT_NEAR(s.width_m, 2.0 * trunk.radius_m, 3.0 * s.width_sd_m);
  EXPECT_NEAR(s.visible_fraction, 0.6, 0.1);
  EXPECT_NEAR(s.gap_left_m, 0.91, 0.05);
}

TEST(Measure, ClockwiseScannersSeeTheSameMirrored) {
  const Things left{{{2.0, 0.03, 0.08}}, {}};
  Scan scan = exact_scan(left, field_scanner());
  const Segment s = measured(scan);
  scan.bearing_min_rad = -scan.bearing_min_rad;
  scan.bearing_step_rad = -scan.bearing_step_rad;
  const Segment mirrored = measured(scan);
  EXPECT_NEAR(mirrored.bearing_rad, -s.bearing_rad, 1e-12);
  EXPECT_EQ(mirrored.width_m, s.width_m);
  ASSERT_TRUE(s.circle && mirrored.circle);
  EXPECT_NEAR(mirrored.circle->y_m, -s.circle->y_m, 1e-9);
  EXPECT_NEAR(mirrored.circle->covariance[1], -s.circle->covariance[1], 1e-12);
  EXPECT_NEAR(mirrored.circle->covariance[4], -s.circle->covariance[4], 1e-12);
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

// A blade of grass behind a gap is no part of the trunk.
TEST(RealScan, ABladeBeyondAGapIsNoPartOfTheTrunk) {
  const Disc trunk{2.0, 0.0, 0.06};
  const Disc in_front{1.2, 0.0475, 0.011};  // hides three beams beside the trunk
  const Disc beyond{2.03, 0.112, 0.006};    // one beam of what shows beyond it
  const auto found = around(segments_of(exact_scan({{trunk, in_front, beyond}, {}}, urg())), 1.95);
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found[0].width_m, 0.16);
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
  EXPECT_DOUBLE_EQ(found[1].intensity, 200.0 + 2800.0 / found[1].num_beams);
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

}  // namespace
}  // namespace orchard::laser
