// SPDX-License-Identifier: BSD-3-Clause
// Truth: a row of trees that is passed again; on the last pass the robot is off by some
// decimetres, so that what it sees becomes landmarks of their own.
#include "pose/slam/duplicate_landmarks.hpp"

#include <gtest/gtest.h>

#include <set>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

constexpr int kNumTrees = 12;
constexpr double kTree_m = 4.0;
constexpr double kSight_m = 8.0;

struct Row {
  SlamGraph graph;
  geometry::PointGrid index{4.0};
  SensorCoverage coverage;

  int add(const Eigen::Vector2d& p_map, double width_m = 0.3) {
    SlamLandmark landmark;
    landmark.p_map = p_map;
    landmark.confirmed = true;
    landmark.add_width(width_m, 0.02);
    graph.landmarks.push_back(landmark);
    const int id = static_cast<int>(graph.landmarks.size()) - 1;
    index.insert(id, p_map);
    return id;
  }

  /// Along the row, all in sight observed but `unseen`.
  void pass(const std::set<int>& unseen) {
    for (double x_m = -4.0; x_m <= kNumTrees * kTree_m; x_m += 0.5) {
      Keyframe keyframe;
      keyframe.T_map_base = {x_m, 0.0, 0.0};
      graph.keyframes.push_back(keyframe);
      const int k = static_cast<int>(graph.keyframes.size()) - 1;
      for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
        const Eigen::Vector2d p =
            geometry::inverse_transform(keyframe.T_map_base, graph.landmarks[l].p_map);
        if (unseen.count(l) != 0 || p.norm() > kSight_m) continue;
        graph.add_observation(k, l, p, 1e-4 * Eigen::Matrix2d::Identity(), 0.02);
        coverage.add_observation(p);
        coverage.add_reobservation(p);
      }
    }
  }

  std::vector<std::pair<int, int>> duplicates() const {
    return find_duplicate_landmarks(graph, index, coverage, SlamConfig{});
  }
};

Row row_of_trees() {
  Row row;
  for (int t = 0; t < kNumTrees; ++t) row.add({kTree_m * t, 3.0});
  // another row behind it: the sensor reaches farther than the trees that are looked for
  for (int t = 0; t < 2 * kNumTrees; ++t) row.add({kTree_m * (t - 4) + 2.0, 6.5});
  return row;
}

TEST(FindTwins, ATreeThatWasTwoIsFound) {
  Row row = row_of_trees();
  row.pass({});
  row.pass({});
  const int twin = row.add({5 * kTree_m + 0.7, 3.4});
  row.pass({5});
  const auto duplicates = row.duplicates();
  ASSERT_EQ(duplicates.size(), 1u);
  EXPECT_EQ(duplicates[0], std::make_pair(twin, 5));
}

TEST(FindTwins, WhatWasSeenSideBySideIsTwo) {
  Row row = row_of_trees();
  row.add({5 * kTree_m + 0.7, 3.4});
  row.pass({});
  row.pass({5});
  EXPECT_TRUE(row.duplicates().empty());
}

TEST(FindTwins, WhatDiffersInWidthOrStandsBeyondHalfASpacingIsTwo) {
  Row row = row_of_trees();
  row.pass({});
  row.add({5 * kTree_m + 0.7, 3.4}, 0.9);
  row.add({8 * kTree_m + 2.1, 3.0});
  row.pass({5, 8});
  EXPECT_TRUE(row.duplicates().empty());
}

}  // namespace
}  // namespace orchard::pose
