// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/scan_loop_closer.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::pose {
namespace {

/// So many points, two metres apart: none is thinned out.
std::vector<SurfacePoint> scan_of(int num, double x_m) {
  std::vector<SurfacePoint> points;
  for (int i = 0; i < num; ++i) {
    SurfacePoint point;
    point.p = {x_m, 2.0 * i};
    point.normal = {0.0, 1.0};
    point.flat = i % 2 == 0;
    points.push_back(point);
  }
  return points;
}

void expect_scan(const KeyframeScans& scans, int keyframe, int num, double x_m) {
  // turned a quarter and shifted: (x, y) comes to lie at (10 - y, 20 + x)
  const std::vector<SurfacePoint> points = scans.points(keyframe, {10.0, 20.0, std::acos(0.0)});
  ASSERT_EQ(points.size(), static_cast<std::size_t>(num));
  double sum_m = 0.0;
  int num_flat = 0;
  for (const SurfacePoint& point : points) {
    EXPECT_NEAR(point.p.y(), 20.0 + x_m, 1e-4);
    sum_m += 10.0 - point.p.x();
    num_flat += point.flat;
    if (point.flat) {
      EXPECT_NEAR(point.normal.x(), -1.0, 1e-6);
    }
  }
  EXPECT_NEAR(sum_m, 1.0 * num * (num - 1), 1e-3 * num);
  EXPECT_EQ(num_flat, (num + 1) / 2);
}

TEST(KeyframeScans, GiveEachKeyframesOwnPoints) {
  KeyframeScans scans;
  for (int k = 0; k < 400; ++k) scans.keep(3 * k, scan_of(k, 0.5 * k));  // more than a chunk
  for (int k = 0; k < 400; ++k) expect_scan(scans, 3 * k, k, 0.5 * k);
  EXPECT_TRUE(scans.has(0));
  EXPECT_FALSE(scans.has(1));
  EXPECT_TRUE(scans.points(1, {0.0, 0.0, 0.0}).empty());
  EXPECT_EQ(scans.between(4, 13), (std::vector<int>{6, 9, 12}));
  EXPECT_EQ(scans.between(6, 12), (std::vector<int>{6, 9}));
}

TEST(KeyframeScans, KeepAScanThatNoChunkHolds) {
  KeyframeScans scans;
  scans.keep(0, scan_of(70'000, 1.0));
  scans.keep(1, scan_of(10, 2.0));
  EXPECT_EQ(scans.points(0, {0.0, 0.0, 0.0}).size(), 70'000u);
  expect_scan(scans, 1, 10, 2.0);
}

}  // namespace
}  // namespace orchard::pose
