// SPDX-License-Identifier: BSD-3-Clause
#include "laser/measure.hpp"

#include <gtest/gtest.h>

#include "laser/candidate.hpp"
#include "laser/splitting/candidate_fit.hpp"
#include "unit/laser/exact_scan.hpp"

namespace orchard::laser {
namespace {

using test::Disc;
using test::exact_scan;
using test::field_scanner;
using test::Things;

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

TEST(Measure, ThePapersWidthIsTheChordOfItsOuterBeams) {
  WidthConfig paper;
  paper.mode = WidthMode::kPaper;
  const Segment s = measured(exact_scan({{{2.0, 0.0, 0.06}}, {}}, field_scanner()), paper);
  const double angle_rad =
      static_cast<double>(s.last_beam - s.first_beam) * field_scanner().step_rad;
  const double r1 = s.start_range_m, r2 = s.end_range_m;
  EXPECT_NEAR(s.width_m, std::sqrt(r1 * r1 + r2 * r2 - 2.0 * r1 * r2 * std::cos(angle_rad)), 1e-9);
  EXPECT_NEAR(s.end_bearing_rad - s.start_bearing_rad, angle_rad, 1e-9);
}

TEST(Measure, TheSpotIsTakenOffTheWidth) {
  LaserConfig wide;
  wide.spot_m = 0.010;
  const Scan scan = exact_scan({{{2.0, 0.0, 0.06}}, {}}, field_scanner());
  const double less_m = measured(scan).width_m - measured(scan, {}, wide).width_m;
  EXPECT_NEAR(less_m, wide.spot_m, 0.001);
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

TEST(Measure, IntensityIsTheMeanOfItsOwnBeams) {
  Scan scan = exact_scan({{{2.0, 0.0, 0.06}}, {}}, field_scanner());
  scan.intensities.assign(scan.ranges_m.size(), 900.0f);
  float next = 100.0f;
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!(scan.ranges_m[i] > 0.0f)) continue;
    scan.intensities[i] = next;
    sum += next;
    next += 10.0f;
    ++count;
  }
  const Segment s = measured(scan);
  EXPECT_NEAR(s.intensity, sum / count, 1e-9);
  EXPECT_EQ(s.intensity_max, next - 10.0f);
  EXPECT_FALSE(s.is_reflector);
}

}  // namespace
}  // namespace orchard::laser
