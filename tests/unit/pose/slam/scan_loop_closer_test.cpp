// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/scan_loop_closer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry/pose2.hpp"
#include "simulation/random.hpp"

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

using Points = std::vector<Eigen::Vector2d>;

constexpr double kCell_m = 0.2;

OccupancyPyramid raster_of(const Points& world) {
  OccupancyPyramid raster({0.0, 0.0}, 40.0, kCell_m, 0.15);
  for (const Eigen::Vector2d& p : world) raster.add({0.0, 0.0}, p);
  raster.finish();
  return raster;
}

/// The world as a submap sees it that lies at T_map_submap.
Points seen_from(const Eigen::Vector3d& T_map_submap, const Points& world) {
  Points points;
  for (const Eigen::Vector2d& p : world) {
    points.push_back(geometry::inverse_transform(T_map_submap, p));
  }
  return points;
}

/// Two walls of a shed, a ragged hedge and some trees.
Points yard(std::uint64_t seed) {
  simulation::Random random(seed);
  Points world;
  for (double s = 0.0; s < 12.0; s += 0.3) world.emplace_back(6.0 + s, 5.0);
  for (double s = 0.0; s < 8.0; s += 0.3) world.emplace_back(6.0, 5.0 + s);
  for (double s = -15.0; s < 15.0; s += 0.3) world.emplace_back(s, -8.0 + random.normal(0.0, 0.2));
  for (int i = 0; i < 15; ++i) {
    world.emplace_back(random.uniform(-18.0, 4.0), random.uniform(-5.0, 18.0));
  }
  return world;
}

int score(const Points& points, const OccupancyPyramid& raster, const Eigen::Vector3d& T) {
  int sum = 0;
  for (const Eigen::Vector2d& p : points) {
    const Eigen::Vector2d p_map = geometry::transform(T, p);
    sum += raster.best(0, raster.column(p_map.x()), raster.row(p_map.y()));
  }
  return sum;
}

TEST(PlaceSearch, FindsTheYardWhereItIs) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Points world = yard(seed);
    const OccupancyPyramid raster = raster_of(world);
    simulation::Random random(100 + seed);
    const Eigen::Vector3d truth(random.uniform(-6.0, 6.0), random.uniform(-6.0, 6.0),
                                random.uniform(-0.3, 0.3));
    const PoseSearchResult place = find_submap_pose(seen_from(truth, world), raster,
                                                    {{0.0, 0.0, 0.0}, 8.0, 0.4}, 1.2, 0.12, 0.2);
    ASSERT_TRUE(place.found);
    EXPECT_FALSE(place.ambiguous) << "seed " << seed;
    EXPECT_LT((place.T_map_submap - truth).head<2>().norm(), 0.3) << "seed " << seed;
    EXPECT_NEAR(place.T_map_submap.z(), truth.z(), 0.02) << "seed " << seed;
  }
}

TEST(PlaceSearch, BoundsLeaveNoBetterPlaceOut) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Points world = yard(seed);
    const OccupancyPyramid raster = raster_of(world);
    // what another visit sees: half of it, and things that are not there
    simulation::Random random(200 + seed);
    Points points;
    for (const Eigen::Vector2d& p : seen_from({1.3, -0.7, 0.06}, world)) {
      if (random.uniform() < 0.5) points.push_back(p);
    }
    for (int i = 0; i < 60; ++i) {
      points.emplace_back(random.uniform(-15.0, 15.0), random.uniform(-15.0, 15.0));
    }
    const PoseSearchWindow window{{0.0, 0.0, 0.0}, 2.0, 0.1};
    const PoseSearchResult place = find_submap_pose(points, raster, window, 1.2, 0.12, 0.2);
    ASSERT_TRUE(place.found);
    // every place of the window, one by one, and more finely than the search turns
    int best = 0;
    double farthest_m = 1.0;
    for (const Eigen::Vector2d& p : points) farthest_m = std::max(farthest_m, p.norm());
    const double step_rad = kCell_m / farthest_m;
    const int turns = static_cast<int>(std::ceil(window.half_turn_rad / step_rad));
    for (int turn = -turns; turn <= turns; ++turn) {
      for (int x = -10; x <= 10; ++x) {
        for (int y = -10; y <= 10; ++y) {
          best = std::max(best, score(points, raster, {x * kCell_m, y * kCell_m, turn * step_rad}));
        }
      }
    }
    EXPECT_NEAR(place.score, 0.01 * best, 1e-9) << "seed " << seed;
  }
}

TEST(PlaceSearch, SaysThatARowRepeats) {
  Points rows;
  for (int row = 0; row < 4; ++row) {
    for (int tree = -8; tree <= 8; ++tree) rows.emplace_back(-6.0 + 4.0 * row, 2.0 * tree);
  }
  const OccupancyPyramid raster = raster_of(rows);
  const PoseSearchResult place = find_submap_pose(seen_from({0.2, 0.1, 0.0}, rows), raster,
                                                  {{0.0, 0.0, 0.0}, 5.0, 0.1}, 1.2, 0.12, 0.2);
  EXPECT_TRUE(place.found);
  EXPECT_TRUE(place.ambiguous);
}

TEST(PlaceSearch, SaysThatAWallAloneTellsNothingAlongIt) {
  Points wall;
  for (double s = -35.0; s < 35.0; s += 0.3) wall.emplace_back(s, 4.0);
  Points part;
  for (double s = -10.0; s < 10.0; s += 0.3) part.emplace_back(s, 4.0);
  const PoseSearchResult place =
      find_submap_pose(part, raster_of(wall), {{0.0, 0.0, 0.0}, 4.0, 0.1}, 1.2, 0.12, 0.2);
  EXPECT_TRUE(place.found);
  EXPECT_TRUE(place.ambiguous);
}

TEST(PlaceSearch, FindsNothingInOtherGround) {
  const OccupancyPyramid raster = raster_of(yard(1));
  simulation::Random random(7);
  Points other;
  for (int i = 0; i < 150; ++i) {
    other.emplace_back(random.uniform(-15.0, 15.0), random.uniform(-15.0, 15.0));
  }
  const PoseSearchResult place =
      find_submap_pose(other, raster, {{0.0, 0.0, 0.0}, 5.0, 0.3}, 1.2, 0.12, 0.2);
  EXPECT_LT(place.score, 0.3 * place.on_known);
}

}  // namespace
}  // namespace orchard::pose
