// SPDX-License-Identifier: BSD-3-Clause
#include "laser/segment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "geometry/angles.hpp"

namespace orchard::laser {
namespace {

using geometry::kPi;

struct Disc {
  double x_m, y_m, radius_m;
};

Scan urg_scan() {
  Scan scan;
  scan.bearing_step_rad = 2.0 * kPi / 1024.0;
  scan.bearing_min_rad = -341.0 * scan.bearing_step_rad;
  scan.range_min_m = 0.02;
  scan.range_max_m = 5.6;
  scan.ranges_m.assign(683, 0.0f);
  return scan;
}

/// Exact ray casting: nearest intersection with any disc.
void cast(Scan& scan, const std::vector<Disc>& discs) {
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double b = scan.bearing_rad(static_cast<double>(i));
    double nearest = std::numeric_limits<double>::infinity();
    for (const Disc& d : discs) {
      const double along = d.x_m * std::cos(b) + d.y_m * std::sin(b);
      const double across = d.y_m * std::cos(b) - d.x_m * std::sin(b);
      if (along <= 0.0 || std::abs(across) >= d.radius_m) continue;
      nearest = std::min(nearest, along - std::sqrt(d.radius_m * d.radius_m - across * across));
    }
    if (std::isfinite(nearest)) scan.ranges_m[i] = static_cast<float>(nearest);
  }
}

double mean_width_m(double diameter_m, double range_m, WidthMode mode) {
  WidthConfig width;
  width.mode = mode;
  double sum = 0.0;
  int n = 0;
  for (double b = -1.5; b < 1.5; b += 0.0107) {
    Scan scan = urg_scan();
    cast(scan, {{range_m * std::cos(b), range_m * std::sin(b), 0.5 * diameter_m}});
    const auto segments = segment(scan, {}, width);
    if (segments.size() != 1) ADD_FAILURE() << segments.size() << " objects at " << range_m;
    for (const Segment& s : segments) sum += s.width_m, ++n;
  }
  return sum / n;
}

TEST(Width, CompensatedIsUnbiasedForTheTube) {
  for (double r = 0.5; r <= 4.0; r += 0.5) {
    EXPECT_NEAR(mean_width_m(0.090, r, WidthMode::kCompensated), 0.090, 0.03 * 0.090) << r;
  }
}

TEST(Width, CompensatedIsUnbiasedForATrunk) {
  for (double r = 0.5; r <= 4.0; r += 0.5) {
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
      Scan scan = urg_scan();
      const double radius_m = 0.5 * (kDiameter_m + spot_m);
      cast(scan, {{range_m * std::cos(b), range_m * std::sin(b), radius_m}});
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

TEST(Segment, NegativeStepsSeeTheSame) {
  Scan scan = urg_scan();
  cast(scan, {{2.0, 0.5, 0.05}, {1.0, -1.0, 0.08}});
  Scan reversed = scan;
  reversed.bearing_min_rad = scan.bearing_rad(682.0);
  reversed.bearing_step_rad = -scan.bearing_step_rad;
  reversed.ranges_m.assign(scan.ranges_m.rbegin(), scan.ranges_m.rend());
  const auto a = segment(scan, {}, {});
  const auto b = segment(reversed, {}, {});
  ASSERT_EQ(a.size(), 2u);
  ASSERT_EQ(b.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(a[i].bearing_rad, b[i].bearing_rad, 1e-9);
    EXPECT_NEAR(a[i].width_m, b[i].width_m, 1e-9);
  }
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
  Scan scan = urg_scan();
  cast(scan, {{2.0, 0.0, 0.10}});
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

TEST(Segment, AFullTurnHasNoSeam) {
  Scan scan = urg_scan();
  scan.bearing_min_rad = -kPi;
  scan.bearing_step_rad = 2.0 * kPi / 897.0;
  scan.ranges_m.assign(897, 0.0f);
  cast(scan, {{-2.0, 0.01, 0.10}});
  const auto segments = segment(scan, {}, {});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_GT(segments[0].first_beam, segments[0].last_beam);
  EXPECT_NEAR(segments[0].width_m, 0.20, 0.02);
  EXPECT_NEAR(std::abs(segments[0].bearing_rad), kPi, 0.02);
}

TEST(Segment, SaysWhoHidesWhom) {
  Scan scan = urg_scan();
  cast(scan, {{1.0, 0.0, 0.05}, {2.0, 0.15, 0.12}});
  const auto segments = segment(scan, {}, {});
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_FALSE(segments[0].occluded_left);
  EXPECT_TRUE(segments[1].occluded_right);
  EXPECT_FALSE(segments[1].occluded_left);
}

TEST(Segment, WallsAreNotReportedAndNothingIsNothing) {
  Scan scan = urg_scan();
  EXPECT_TRUE(segment(scan, {}, {}).empty());
  scan.ranges_m.assign(683, 3.0f);
  EXPECT_TRUE(segment(scan, {}, {}).empty());
  EXPECT_TRUE(segment(Scan{}, {}, {}).empty());
}

TEST(Segment, TheBlindSectorIsBlind) {
  Scan scan = urg_scan();
  cast(scan, {{2.0, 0.0, 0.05}, {2.0, 1.0, 0.05}});
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

}  // namespace
}  // namespace orchard::laser
