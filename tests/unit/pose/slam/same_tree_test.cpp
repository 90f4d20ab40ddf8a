// SPDX-License-Identifier: BSD-3-Clause
// Truth: trees along a straight drive that is driven twice. The wheels alone lead from the first
// pass to the second, so their error is that of the second pass unless trees of the first are
// observed again.
#include "pose/slam/same_tree.hpp"

#include <gtest/gtest.h>

#include <set>

#include "geometry/pose2.hpp"
#include "pose/graph/solver.hpp"

namespace orchard::pose {
namespace {

constexpr int kNumTrees = 12;
constexpr double kTree_m = 4.0;
constexpr double kSight_m = 8.0;

struct TwoPasses {
  SlamGraph graph;
  geometry::PointGrid index{4.0};
  SensorCoverage coverage;

  TwoPasses() { graph.calibrations.emplace_back(OdometryCalibration::Zero()); }

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

  /// Adds a keyframe that observes all in sight but `unseen`; `sd_m`: of the way to it.
  void observe(double x_m, double sd_m, const std::set<int>& unseen) {
    Keyframe keyframe;
    keyframe.T_map_base = {x_m, 0.0, 0.0};
    if (!graph.keyframes.empty()) {
      const Keyframe& before = graph.keyframes.back();
      keyframe.motion.delta = geometry::between(before.T_map_base, keyframe.T_map_base);
      keyframe.motion.travel_m = 0.5;
      keyframe.motion.covariance = Eigen::Vector3d(sd_m * sd_m, sd_m * sd_m, 1e-6).asDiagonal();
      keyframe.travel_m = before.travel_m + 0.5;
    }
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

  void pass(const std::set<int>& unseen, double drift_sd_m = 0.3) {
    for (double x_m = -4.0; x_m <= kNumTrees * kTree_m; x_m += 0.5) {
      observe(x_m, x_m == -4.0 ? drift_sd_m : 0.01, unseen);
    }
  }

  std::vector<std::pair<int, int>> same() const {
    return find_same_trees(graph, index, coverage, SlamConfig{});
  }
};

TwoPasses first_pass() {
  TwoPasses drive;
  for (int t = 0; t < kNumTrees; ++t) drive.add({kTree_m * t, 3.0});
  // another row behind it: the sensor reaches farther than the trees that are looked for
  for (int t = 0; t < 2 * kNumTrees; ++t) drive.add({kTree_m * (t - 4) + 2.0, 6.5});
  drive.pass({});
  return drive;
}

/// On the second pass, `num_again` trees in a row are landmarks of their own, off by offset_m, and
/// the first pass's are observed only if they are `common`.
TwoPasses second_pass(int num_again, const Eigen::Vector2d& offset_m, double drift_sd_m,
                      bool common, double width_m = 0.3) {
  TwoPasses drive = first_pass();
  std::set<int> unseen;
  for (int t = 0; t < 3 * kNumTrees; ++t) {
    if (!common || (t >= 4 && t < 4 + num_again)) unseen.insert(t);
  }
  for (int t = 4; t < 4 + num_again; ++t) {
    drive.add(drive.graph.landmarks[static_cast<std::size_t>(t)].p_map + offset_m, width_m);
  }
  drive.pass(unseen, drift_sd_m);
  return drive;
}

TEST(FindSameTrees, ATreeSeenAgainAfterDriftIsOne) {
  const auto same = second_pass(3, {0.3, 0.1}, 0.3, false).same();
  ASSERT_EQ(same.size(), 3u);
  for (const auto& [l, other] : same) EXPECT_EQ(other - l, 3 * kNumTrees - 4);
}

TEST(FindSameTrees, AnyTreeMayLieThereAfterLongDrift) {
  EXPECT_TRUE(second_pass(1, {0.0, 0.0}, 20.0, false).same().empty());
}

TEST(FindSameTrees, WhereThePoseIsKnownATreeBesideIsAnother) {
  EXPECT_TRUE(second_pass(1, {0.6, 0.3}, 0.3, true).same().empty());
  EXPECT_EQ(second_pass(1, {0.05, 0.05}, 0.3, true).same().size(), 1u);
}

TEST(FindSameTrees, ATrunkOfAnotherWidthIsAnotherTree) {
  EXPECT_TRUE(second_pass(3, {0.3, 0.1}, 0.3, false, 0.9).same().empty());
}

TEST(FindSameTrees, WhatWasSeenSideBySideIsTwo) {
  TwoPasses drive = first_pass();
  drive.add({5 * kTree_m + 0.35, 3.0});
  drive.pass({});
  EXPECT_TRUE(drive.same().empty());
}

TEST(FindSameTrees, WhatOverlapsInOneScanIsOne) {
  TwoPasses drive = first_pass();
  const int part = drive.add({5 * kTree_m + 0.2, 3.0});
  drive.pass({});
  const auto same = drive.same();
  ASSERT_EQ(same.size(), 1u);
  EXPECT_EQ(same[0], std::make_pair(5, part));
}

TEST(MissedLogRatio, ATreeMissedWhereOthersAreSeenIsTheOther) {
  const auto ratio = [](const std::set<int>& unseen) {
    TwoPasses drive = first_pass();
    const int twin = drive.add({5 * kTree_m + 0.7, 3.4});
    drive.pass(unseen);
    return missed_log_ratio(drive.graph, drive.index, drive.coverage, twin, 5);
  };
  EXPECT_EQ(ratio({}), 0.0);
  EXPECT_GT(ratio({5}), 1.5);
  EXPECT_GT(ratio({4, 5, 6}), 0.0);
  EXPECT_LT(ratio({4, 5, 6}), ratio({5}));
}

/// Two keyframes 2 m apart, a tree 3 m ahead of each. Truth: the errors of the two observations,
/// of the motion, and of its turn times the distance add up.
TEST(RelativeCovariances, OfTreesThatOnlyTheMotionJoins) {
  TwoPasses drive;
  drive.add({3.0, 0.0});
  drive.add({5.0, 0.0});
  drive.observe(0.0, 0.0, {1});
  drive.observe(2.0, 0.1, {0});
  drive.graph.keyframes[1].motion.covariance(2, 2) = 0.02 * 0.02;
  const auto P = relative_covariances(drive.graph, {{0, 1}}, SlamConfig{});
  ASSERT_TRUE(P.has_value());
  const double observed_m2 = 2.0 * (1e-4 + 0.02 * 0.02);
  EXPECT_NEAR((*P)[0](0, 0), observed_m2 + 0.01, 1e-6);
  EXPECT_NEAR((*P)[0](1, 1), observed_m2 + 0.01 + 9.0 * 0.02 * 0.02, 1e-6);
  EXPECT_NEAR((*P)[0](0, 1), 0.0, 1e-9);
}

/// The same, but both keyframes observe a third tree. Truth: the motion's error along x shrinks to
/// that of the two observations of it, combined with the motion.
TEST(RelativeCovariances, OfTreesThatACommonTreeJoins) {
  TwoPasses drive;
  drive.add({3.0, 0.0});
  drive.add({5.0, 0.0});
  drive.add({4.0, 0.0});
  drive.observe(0.0, 0.0, {1});
  drive.observe(2.0, 0.1, {0});
  const auto P = relative_covariances(drive.graph, {{0, 1}}, SlamConfig{});
  ASSERT_TRUE(P.has_value());
  const double observed_m2 = 1e-4 + 0.02 * 0.02;
  const double moved_m2 = 1.0 / (1.0 / 0.01 + 1.0 / (2.0 * observed_m2));
  EXPECT_NEAR((*P)[0](0, 0), 2.0 * observed_m2 + moved_m2, 1e-6);
}

}  // namespace
}  // namespace orchard::pose
