// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/visibility.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "geometry/angles.hpp"

namespace orchard::geometry {
namespace {

using Eigen::Vector2d;

Vector2d at(double range_m, double bearing_rad) {
  return range_m * Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
}

/// Whether the line from the origin to p passes through a disc before it ends, by the distance of
/// the disc's centre from the line.
bool crosses(const Vector2d& p, const Vector2d& centre, double radius_m) {
  const double along_m = centre.dot(p.normalized());
  const double beside_m = (centre - along_m * p.normalized()).norm();
  return beside_m < radius_m && along_m > 0.0 && along_m < p.norm();
}

TEST(Visibility, OutlineIsBetweenTheTangents) {
  const Vector2d centre = at(5.0, 2.9);
  const double radius_m = 0.4;
  const Outline outline = outline_of(centre, radius_m);
  EXPECT_NEAR(outline.distance_m, 5.0, 1e-12);
  EXPECT_NEAR(outline.bearing_rad, 2.9, 1e-12);
  for (const double side : {-1.0, 1.0}) {
    const Vector2d tangent = at(10.0, outline.bearing_rad + side * outline.half_rad);
    const Vector2d inside = at(10.0, outline.bearing_rad + side * (outline.half_rad - 1e-6));
    const Vector2d outside = at(10.0, outline.bearing_rad + side * (outline.half_rad + 1e-6));
    EXPECT_NEAR(std::abs(tangent.x() * centre.y() - tangent.y() * centre.x()) / 10.0, radius_m,
                1e-12);
    EXPECT_TRUE(crosses(inside, centre, radius_m));
    EXPECT_FALSE(crosses(outside, centre, radius_m));
  }
  EXPECT_NEAR(outline_of({0.1, 0.0}, 0.4).half_rad, 0.5 * kPi, 1e-12);
}

TEST(Visibility, SectorsDivideTheCircle) {
  std::set<std::size_t> seen;
  for (int k = 0; k < 360; ++k) {
    const std::size_t sector = sector_of(at(3.0, -kPi + (k + 0.5) * kPi / 180.0), 36);
    EXPECT_EQ(sector, static_cast<std::size_t>(k / 10));
    seen.insert(sector);
  }
  EXPECT_EQ(seen.size(), 36u);
  EXPECT_EQ(sector_of({-1.0, 0.0}, 36), 35u);  // +pi belongs to the last
}

TEST(Visibility, HidesWhatTheSightLinesCannotReach) {
  const Vector2d trunk = at(4.0, 0.7);
  const double width_m = 0.2;
  OcclusionTest occlusion;
  EXPECT_FALSE(occlusion.occludes(at(8.0, 0.7)));
  occlusion.add(trunk, width_m);
  for (int k = -200; k <= 200; ++k) {
    for (const double range_m : {2.0, 3.9, 4.5, 6.0, 12.0}) {
      const Vector2d p = at(range_m, 0.7 + 1e-3 * k);
      // the centre's line of sight is cut: hidden for sure, but for what is the trunk itself
      if (range_m > 4.4 && crosses(p, trunk, 0.5 * width_m)) {
        EXPECT_TRUE(occlusion.occludes(p)) << k << " " << range_m;
      }
      // clear by far more than the borders, or nearer than the trunk: seen for sure
      if (range_m < 4.2 || !crosses(p, trunk, 0.5 * width_m + 0.2)) {
        EXPECT_FALSE(occlusion.occludes(p)) << k << " " << range_m;
      }
    }
  }
  EXPECT_FALSE(occlusion.occludes(at(8.0, 0.7 + kPi)));
}

TEST(Visibility, WhatStandsInTheScannerHidesNothing) {
  OcclusionTest occlusion;
  occlusion.add({0.0, 0.0}, 0.2);
  EXPECT_FALSE(occlusion.occludes({5.0, 0.0}));
}

}  // namespace
}  // namespace orchard::geometry
