// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_map.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <memory>

namespace orchard::pose {
namespace {

/// Six keyframes along x; one tree, mapped as landmark 0 by the first three and as 1 by the others.
SlamMap tree_mapped_twice() {
  SlamMap map{SlamConfig{}};
  SlamGraph& graph = map.graph;
  for (int l = 0; l < 2; ++l) {
    SlamLandmark landmark;
    landmark.p_map = {3.0, 2.0 + 0.3 * l};
    landmark.confirmed = true;
    graph.landmarks.push_back(landmark);
  }
  for (int k = 0; k < 6; ++k) {
    Keyframe keyframe;
    keyframe.utime = 100'000 * k;
    keyframe.T_map_base = {1.0 * k, 0.0, 0.0};
    keyframe.travel_m = 1.0 * k;
    graph.keyframes.push_back(keyframe);
    graph.add_observation(k, k < 3 ? 0 : 1, {3.0 - k, 2.0}, 0.01 * Eigen::Matrix2d::Identity(),
                          0.02);
    if (k < 4) graph.keyframes.back().observations.keep(*graph.memory);
  }
  graph.landmarks[0].add_width(0.1, 0.01);
  graph.landmarks[1].add_width(0.14, 0.01);
  return map;
}

/// What a closure does to a map, and something to every member that a solve may change.
void change(SlamMap& map) {
  map.graph.merge(1, 0);
  for (Keyframe& keyframe : map.graph.keyframes) {
    keyframe.T_map_base.y() += 1.0;
    keyframe.covariance.setIdentity();
    keyframe.calibration_cross.setOnes();
    keyframe.calibration_covariance.setOnes();
  }
  for (SlamLandmark& landmark : map.graph.landmarks) {
    landmark.p_map.y() += 1.0;
    landmark.information.setIdentity();
  }
  map.graph.calibrations.push_back({0.1, 0.2, 0.3});
  map.graph.relative_poses.emplace_back();
  map.local = {7, 8};
  map.session_start = map.num_solved = 5;
  map.lost = map.corrected = true;
}

void expect_same(const SlamMap& map, const SlamMap& was) {
  ASSERT_EQ(map.graph.keyframes.size(), was.graph.keyframes.size());
  for (std::size_t k = 0; k < was.graph.keyframes.size(); ++k) {
    const Keyframe &now = map.graph.keyframes[k], &then = was.graph.keyframes[k];
    EXPECT_EQ(now.T_map_base, then.T_map_base);
    EXPECT_EQ(now.covariance, then.covariance);
    EXPECT_EQ(now.calibration_cross, then.calibration_cross);
    EXPECT_EQ(now.calibration_covariance, then.calibration_covariance);
    ASSERT_EQ(now.observations.size(), then.observations.size());
    EXPECT_EQ(now.observations[0].landmark, then.observations[0].landmark) << "of keyframe " << k;
    EXPECT_EQ(now.observations[0].information_m, then.observations[0].information_m);
  }
  ASSERT_EQ(map.graph.landmarks.size(), was.graph.landmarks.size());
  for (std::size_t l = 0; l < was.graph.landmarks.size(); ++l) {
    const SlamLandmark &now = map.graph.landmarks[l], &then = was.graph.landmarks[l];
    EXPECT_EQ(now.p_map, then.p_map);
    EXPECT_EQ(now.information, then.information);
    EXPECT_EQ(now.width_m, then.width_m);
    EXPECT_EQ(now.keyframes, then.keyframes);
    EXPECT_EQ(now.alive, then.alive);
    EXPECT_EQ(now.confirmed, then.confirmed);
  }
  EXPECT_EQ(map.graph.calibrations.size(), was.graph.calibrations.size());
  EXPECT_EQ(map.graph.relative_poses.size(), was.graph.relative_poses.size());
  EXPECT_EQ(map.local, was.local);
  EXPECT_EQ(map.session_start, was.session_start);
  EXPECT_EQ(map.num_solved, was.num_solved);
  EXPECT_EQ(map.lost, was.lost);
  EXPECT_EQ(map.corrected, was.corrected);
}

TEST(SlamUndo, PutsEverythingBack) {
  SlamMap map = tree_mapped_twice();
  const SlamMap was = map;
  {
    SlamUndo undo(map);
    change(map);
    EXPECT_EQ(map.graph.landmarks[0].keyframes.size(), 6u);
    undo.restore();
  }
  expect_same(map, was);
  EXPECT_FALSE(map.graph.merges) << "merges are not recorded any more";
}

TEST(SlamUndo, LeavesAMapThatIsRight) {
  SlamMap map = tree_mapped_twice();
  {
    SlamUndo undo(map);
    change(map);
  }
  EXPECT_EQ(map.graph.landmarks[0].keyframes.size(), 6u);
  EXPECT_FALSE(map.graph.landmarks[1].alive);
  EXPECT_EQ(map.session_start, 5);
}

/// A sum of older observations equals the sum over all keyframes, however the window moves.
TEST(OlderSums, EqualTheWholeSum) {
  SlamMap map = tree_mapped_twice();
  map.graph.merge(1, 0);
  SlamGraph all = map.graph;
  all.update_landmark(0, true);
  for (const int first : {2, 4, 5, 3}) {
    map.graph.older.start(first);
    EXPECT_EQ(map.graph.older_sum(0).num_keyframes, static_cast<std::size_t>(first));
    map.graph.update_landmark(0, true);
    EXPECT_EQ(map.graph.landmarks[0].information, all.landmarks[0].information);
    EXPECT_EQ(map.graph.landmarks[0].p_map, all.landmarks[0].p_map);
  }
}

}  // namespace
}  // namespace orchard::pose
