// SPDX-License-Identifier: BSD-3-Clause
#include "system/real_recordings/clear_trees.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "worlds/landmark.hpp"

namespace orchard::test {
namespace {

/// As many scans from the origin, the robot looking along y, at a trunk 0.2 m wide and 3 m away.
std::vector<io::SensorMessage> trunk_seen(int num_scans) {
  std::vector<io::SensorMessage> recording;
  for (int k = 0; k < num_scans; ++k) {
    laser::Scan scan;
    scan.utime = 1000000 * k;
    scan.bearing_min_rad = -0.5;
    scan.bearing_step_rad = 0.01;
    scan.ranges_m.assign(101, 0.0f);
    for (std::size_t i = 47; i <= 53; ++i) scan.ranges_m[i] = 3.0f;
    pose::PoseFix fix;
    fix.utime = scan.utime;
    fix.yaw_rad = 0.5 * std::acos(-1.0);
    recording.push_back(scan);
    recording.push_back(fix);
  }
  return recording;
}

mapping::Landmark tree_at(double x_m, double y_m, int n = 20) {
  return test::tree(0, x_m, y_m, 0.0, n);
}

TEST(ClearTrees, FindsATrunkSeenOftenEnough) {
  const auto trees = find_clear_trees(trunk_seen(20));
  ASSERT_EQ(trees.size(), 1u);
  EXPECT_NEAR(trees[0].x_m, 0.0, 1e-6);
  EXPECT_NEAR(trees[0].y_m, 3.0 + 0.5 * 3.0 * 7 * 0.01, 1e-6);
  EXPECT_NEAR(trees[0].support, 20.0, 1e-6);
  EXPECT_TRUE(find_clear_trees(trunk_seen(14)).empty());
}

TEST(ClearTrees, SeesMissingAndDoubledLandmarks) {
  const std::vector<ClearTree> trees{{0.0, 0.0, 20.0}, {5.0, 0.0, 20.0}, {10.0, 0.0, 20.0}};
  const auto comparison = compare(
      trees, {tree_at(0.1, 0.0), tree_at(5.0, 0.2), tree_at(5.3, 0.0), tree_at(10.0, 0.0, 9)});
  EXPECT_EQ(comparison.num_landmarks, (std::vector<int>{1, 2, 0}));
  EXPECT_EQ(comparison.num_doubled(), 1);
  EXPECT_EQ(comparison.num_with(0), 1);
  EXPECT_EQ(comparison.num_tree_landmarks, 3);
  EXPECT_DOUBLE_EQ(comparison.median_distance_m(), 0.1);
}

}  // namespace
}  // namespace orchard::test
