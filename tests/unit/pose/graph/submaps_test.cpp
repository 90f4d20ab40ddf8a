// SPDX-License-Identifier: BSD-3-Clause
// Truth: a path along a row of trees, seen without error; then bent, as a drift would.
#include "pose/graph/submaps.hpp"
#include "geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pose/graph/solver.hpp"

namespace orchard::pose {
using geometry::between;
using geometry::compose;
using geometry::compose_jacobian_first;
using geometry::compose_jacobian_second;
using geometry::inverse_transform;
using geometry::transform;

namespace {

constexpr int kNumKeyframes = 121;
constexpr double kStepM = 0.5;

Eigen::Vector2d tree(int l) { return {2.0 * l, l % 2 == 0 ? 2.0 : -2.0}; }

/// A quarter of a turn over the whole path.
Eigen::Vector3d motion_true() { return {kStepM, 0.0, 0.5 * geometry::kPi / kNumKeyframes}; }

/// Keyframes where they are, what each sees within 6 m, and odometry without error.
SlamGraph world() {
  SlamGraph graph;
  graph.calibrations.push_back(OdometryCalibration::Zero());
  for (int l = 0; l < 40; ++l) {
    SlamLandmark landmark;
    landmark.p_map = tree(l);
    landmark.confirmed = true;
    graph.landmarks.push_back(landmark);
  }
  for (int k = 0; k < kNumKeyframes; ++k) {
    Keyframe keyframe;
    keyframe.utime = 500000 * k;
    if (k > 0) {
      const Keyframe& before = graph.keyframes.back();
      keyframe.T_map_base = compose(before.T_map_base, motion_true());
      keyframe.travel_m = before.travel_m + kStepM;
      keyframe.motion.delta = motion_true();
      keyframe.motion.covariance = Eigen::Vector3d(1e-4, 1e-4, 1e-5).asDiagonal();
      keyframe.motion.travel_m = kStepM;
    }
    graph.keyframes.push_back(keyframe);
    for (int l = 0; l < 40; ++l) {
      const Eigen::Vector2d p = inverse_transform(keyframe.T_map_base, tree(l));
      if (p.norm() < 6.0) graph.add_observation(k, l, p, 4e-4 * Eigen::Matrix2d::Identity(), 0.005);
    }
  }
  return graph;
}

// Before the first tree the way is what the wheels say, off by a twentieth: 0.3 m over 6 m.
TEST(Submaps, WhatOnlyTheWheelsSayIsNoRigidShape) {
  SlamGraph graph = world();
  const auto num_before = [](const SlamGraph& of) {
    const SubmapGraph submaps = submaps_of(of, SlamConfig{});
    return std::count_if(submaps.keyframes.begin(), submaps.keyframes.end(),
                         [](int k) { return k > 0 && k <= 12; });
  };
  for (Keyframe& k : graph.keyframes) k.motion.calibration_jacobian(0, 0) = kStepM;
  EXPECT_EQ(num_before(graph), 0);
  for (int k = 0; k <= 12; ++k) graph.keyframes[k].observations.edit().clear();
  EXPECT_GE(num_before(graph), 4);
}

TEST(Submaps, SumUpTheirKeyframesObservations) {
  const SlamGraph graph = world();
  SlamConfig config;
  config.submap_length_m = 5.0;
  const SubmapGraph submaps = submaps_of(graph, config);
  ASSERT_LT(submaps.graph.keyframes.size(), 17u);  // the path leaves the trees behind
  ASSERT_GT(submaps.graph.keyframes.size(), 10u);
  int num_scans = 0, num_scans_then = 0;
  for (const Keyframe& k : graph.keyframes) {
    for (const SlamObservation& s : k.observations) num_scans += s.num_scans;
  }
  for (std::size_t i = 0; i < submaps.graph.keyframes.size(); ++i) {
    const Keyframe& submap = submaps.graph.keyframes[i];
    for (const SlamObservation& s : submap.observations) {
      num_scans_then += s.num_scans;
      // the same place, from the middle of the submap
      EXPECT_LT((transform(submap.T_map_base, s.position()) - tree(s.landmark)).norm(), 1e-9);
    }
    if (i == 0) continue;
    const Eigen::Vector3d apart =
        between(submaps.graph.keyframes[i - 1].T_map_base, submap.T_map_base);
    EXPECT_LT((submap.motion.delta - apart).norm(), 1e-9);
    EXPECT_NEAR(submap.motion.travel_m, submap.travel_m - submaps.graph.keyframes[i - 1].travel_m,
                1e-9);
  }
  EXPECT_EQ(num_scans_then, num_scans);
}

TEST(Submaps, TheDerivativeByTheOdometryCalibrationIsKept) {
  // speed and turn too large by a fraction each: the motion over a submap as with one long keyframe
  SlamGraph graph;
  graph.calibrations.push_back(OdometryCalibration::Zero());
  RelativeMotion whole;
  Keyframe keyframe;
  graph.keyframes.push_back(keyframe);
  for (int k = 1; k <= 8; ++k) {
    keyframe.motion = RelativeMotion();
    for (int step = 0; step < 10; ++step) {
      keyframe.motion.drive(1.0, 0.2, {1e-4, 0.0, 1e-5}, 0.05);
      whole.drive(1.0, 0.2, {1e-4, 0.0, 1e-5}, 0.05);
    }
    keyframe.travel_m += 0.5;
    graph.keyframes.push_back(keyframe);
  }
  SlamConfig config;
  config.submap_length_m = 1.9;
  const SubmapGraph submaps = submaps_of(graph, config);
  RelativeMotion sum;
  Eigen::Matrix3d E = Eigen::Matrix3d::Zero();
  Eigen::Vector3d T = Eigen::Vector3d::Zero();
  for (std::size_t i = 1; i < submaps.graph.keyframes.size(); ++i) {
    const RelativeMotion& m = submaps.graph.keyframes[i].motion;
    E = compose_jacobian_first(T, m.delta) * E +
        compose_jacobian_second(T) * m.calibration_jacobian;
    T = compose(T, m.delta);
  }
  // the last pose stands before the end: compare over the same way
  RelativeMotion same;
  const int last = submaps.keyframes.back();
  for (int step = 0; step < 10 * last; ++step) same.drive(1.0, 0.2, {1e-4, 0.0, 1e-5}, 0.05);
  EXPECT_LT((T - same.delta).norm(), 1e-9);
  EXPECT_LT((E - same.calibration_jacobian).norm(), 1e-9);
}

TEST(Submaps, BlindMotionEndsASubmap) {
  SlamGraph graph = world();
  for (Keyframe& k : graph.keyframes) k.motion.covariance *= 1e-4;
  graph.keyframes[43].motion.covariance(0, 0) = 0.3 * 0.3;
  SlamConfig config;
  config.submap_length_m = 100.0;
  const SubmapGraph submaps = submaps_of(graph, config);
  ASSERT_EQ(submaps.graph.keyframes.size(), 2u);
  EXPECT_EQ(submaps.submap_of[42], 0);
  EXPECT_EQ(submaps.submap_of[43], 1);
}

TEST(Submaps, ADriftIsTakenOutAndTheKeyframesFollow) {
  const SlamGraph truth = world();
  SlamGraph graph = truth;
  // Each 5 m of path are right in themselves; where two meet, the path bends.
  for (int k = 1; k < kNumKeyframes; ++k) {
    Eigen::Vector3d motion = motion_true();
    if (k % 11 == 0) motion.z() += 0.01;
    graph.keyframes[k].T_map_base = compose(graph.keyframes[k - 1].T_map_base, motion);
  }
  for (std::size_t l = 0; l < graph.landmarks.size(); ++l) {
    graph.update_landmark(static_cast<int>(l), true);
  }
  SlamConfig config;
  config.submap_length_m = 5.0;
  SubmapGraph submaps = submaps_of(graph, config);
  ASSERT_TRUE(solve_graph(submaps.graph, false, config).solved);
  const SlamGraph drifted = graph;
  back_substitute(submaps, graph);
  double before_m = 0.0, after_m = 0.0;
  for (int k = 1; k < kNumKeyframes; ++k) {
    const Eigen::Vector3d& T = truth.keyframes[k].T_map_base;
    const auto off_m = [&](const SlamGraph& g) {
      return (g.keyframes[k].T_map_base - T).head<2>().norm();
    };
    before_m = std::max(before_m, off_m(drifted));
    after_m = std::max(after_m, off_m(graph));
    // no step where one submap ends and the next begins
    const Eigen::Vector3d step =
        between(graph.keyframes[k - 1].T_map_base, graph.keyframes[k].T_map_base);
    EXPECT_NEAR(step.x(), kStepM, 0.02);
    EXPECT_NEAR(step.y(), 0.0, 0.02);
    if (k > 10) {
      EXPECT_GT(graph.keyframes[k].covariance(0, 0), 0.0);
    }
  }
  EXPECT_GT(before_m, 1.0);
  EXPECT_LT(after_m, 0.1 * before_m);
  for (int l = 0; l < 20; ++l) {
    if (graph.landmarks[l].keyframes.empty()) continue;
    EXPECT_LT((graph.landmarks[l].p_map - tree(l)).norm(), 0.1 * before_m) << "landmark " << l;
  }
}

}  // namespace
}  // namespace orchard::pose
