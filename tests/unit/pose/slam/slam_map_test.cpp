// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/slam_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

constexpr double kRing_m = 10.0;

constexpr int kTrunks = 600;

/// A drive of that many metres, a keyframe each, round and round inside a ring of trunks of which
/// each keyframe sees twelve: every place is tied to every other. The poses drift by half a metre.
SlamMap rounds_inside_a_ring(int num_keyframes) {
  SlamMap map{SlamConfig{}};
  SlamGraph& graph = map.graph;
  std::vector<Eigen::Vector2d> trunks;
  for (int l = 0; l < kTrunks; ++l) {
    const double at_rad = 2.0 * M_PI * l / kTrunks;
    // The origin lies on the path, which leaves it along x.
    trunks.emplace_back(1.4 * kRing_m * std::sin(at_rad),
                        kRing_m - 1.4 * kRing_m * std::cos(at_rad));
    SlamLandmark landmark;
    landmark.p_map = trunks.back();
    landmark.confirmed = true;
    landmark.add_width(0.1, 0.01);
    graph.landmarks.push_back(landmark);
  }
  const Eigen::Vector3d step(kRing_m * std::sin(1.0 / kRing_m),
                             kRing_m * (1.0 - std::cos(1.0 / kRing_m)), 1.0 / kRing_m);
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  for (int k = 0; k < num_keyframes; ++k) {
    Keyframe keyframe;
    keyframe.utime = 100'000 * k;
    keyframe.travel_m = k;
    keyframe.T_map_base = T;
    if (k > 0) {
      keyframe.motion.delta = step;
      keyframe.motion.covariance = 1e-4 * Eigen::Matrix3d::Identity();
      keyframe.motion.travel_m = 1.0;
      keyframe.T_map_base.x() += 0.5 * k / num_keyframes;
    }
    graph.keyframes.push_back(keyframe);
    for (int i = 0; i < 12; ++i) {
      const int l = (31 * k + 53 * i) % kTrunks;
      graph.add_observation(k, l, geometry::inverse_transform(T, trunks[l]),
                            1e-4 * Eigen::Matrix2d::Identity(), 0.01);
    }
    T = geometry::compose(T, step);
  }
  return map;
}

double farthest_from_ring_m(const SlamMap& map) {
  double farthest_m = 0.0;
  for (const Keyframe& k : map.graph.keyframes) {
    const double radius_m = (k.T_map_base.head<2>() - Eigen::Vector2d(0.0, kRing_m)).norm();
    farthest_m = std::max(farthest_m, std::abs(radius_m - kRing_m));
  }
  return farthest_m;
}

TEST(SlamMap, SubmapsGrowWhereReturningFillsTheFactor) {
  // The dense factor of three unknowns per submap of nine keyframes takes (n / 3)^3 / 3
  // multiplications for n keyframes, and 5.7e4 n are allowed: as many for n = 2150.
  SlamMap few = rounds_inside_a_ring(900);
  ASSERT_TRUE(few.solve(SolveReason::kGrowth));
  EXPECT_EQ(few.submap_length_m(), SlamConfig{}.submap_length_m);
  EXPECT_LT(farthest_from_ring_m(few), 0.05);
  SlamMap many = rounds_inside_a_ring(2700);
  ASSERT_TRUE(many.solve(SolveReason::kGrowth));
  EXPECT_EQ(many.submap_length_m(), 2.0 * SlamConfig{}.submap_length_m);
  EXPECT_LT(farthest_from_ring_m(many), 0.05);
}

/// A drive along x, a keyframe a metre, of which the first six see landmark 0, the others landmark
/// 1. At the seventh a session begins, for the motion to it has that standard deviation, and so has
/// the place in the map of all that follow.
SlamMap after_a_gap(double motion_sd_m, bool has_guess, double place_sd_m) {
  SlamMap map{SlamConfig{}};
  SlamGraph& graph = map.graph;
  for (int l = 0; l < 2; ++l) {
    SlamLandmark landmark;
    landmark.p_map = {5.0 + 2.0 * l, 2.0};
    landmark.confirmed = true;
    graph.landmarks.push_back(landmark);
    map.index.insert(l, landmark.p_map);
  }
  for (int k = 0; k < 10; ++k) {
    Keyframe keyframe;
    keyframe.T_map_base = {1.0 * k, 0.0, 0.0};
    keyframe.travel_m = k;
    keyframe.covariance.diagonal().head<2>().fill(place_sd_m * place_sd_m);
    keyframe.local_covariance.diagonal().head<2>().fill(motion_sd_m * motion_sd_m);
    keyframe.motion.has_guess = has_guess;
    graph.keyframes.push_back(keyframe);
    if (k == 6) map.start_session(false);
    const int l = k < 6 ? 0 : 1;
    graph.add_observation(k, l, graph.landmarks[l].p_map - Eigen::Vector2d(k, 0.0),
                          1e-4 * Eigen::Matrix2d::Identity(), 0.01);
    map.coverage.add_observation({8.0, 0.0});
  }
  map.refresh_local();
  return map;
}

TEST(SlamMap, AfterAGuessedMotionNothingOfBeforeIsMetByChance) {
  const double far_m = 1.1 * SlamConfig{}.lost_sd_m, near_m = 0.9 * SlamConfig{}.lost_sd_m;
  const std::vector<int> own{1}, all{0, 1};
  EXPECT_EQ(after_a_gap(far_m, true, far_m).local, own);
  EXPECT_EQ(after_a_gap(near_m, true, far_m).local, all) << "began for another reason";
  EXPECT_EQ(after_a_gap(far_m, false, far_m).local, all) << "where wheels tell is likeliest";
  EXPECT_EQ(after_a_gap(far_m, true, near_m).local, all) << "fixes tell where it is";
  SlamMap joined = after_a_gap(far_m, true, far_m);
  joined.session_start = 0;
  joined.refresh_local();
  EXPECT_EQ(joined.local, all);
}

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
