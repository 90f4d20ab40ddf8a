// SPDX-License-Identifier: BSD-3-Clause
#include "pose/graph/told_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/pose2.hpp"

namespace orchard::pose {
namespace {

constexpr std::int64_t kSecond_us = 1'000'000;

/// Keyframes a second and a metre apart along x.
SlamGraph straight(int num_keyframes) {
  SlamGraph graph;
  graph.calibrations.push_back(OdometryCalibration::Zero());
  for (int k = 0; k < num_keyframes; ++k) {
    Keyframe keyframe;
    keyframe.utime = k * kSecond_us;
    keyframe.T_map_base = {static_cast<double>(k), 0.0, 0.0};
    keyframe.covariance = (1.0 + k) * Eigen::Matrix3d::Identity();
    if (k > 0) keyframe.motion.delta = {1.0, 0.0, 0.0};
    graph.keyframes.push_back(keyframe);
  }
  return graph;
}

/// A pose on another straight line.
Eigen::Vector3d on_line(double way_m) {
  return geometry::compose(Eigen::Vector3d(7.0, 3.0, 0.5), Eigen::Vector3d(way_m, 0.0, 0.0));
}

/// The place a drive along x has reached after so many seconds.
ToldPath::Place place_at(double time_s) {
  const int k = static_cast<int>(time_s);
  return {static_cast<std::int64_t>(1e6 * time_s), k, {time_s - k, 0.0, 0.0}};
}

/// Tells poses four times a second, from `from_s` on by `jump_m` beside those before.
void tell(ToldPath& told, const SlamGraph& graph, double to_s, double from_s, double jump_m) {
  for (double time_s = 0.0; time_s <= to_s; time_s += 0.25) {
    told.tell(place_at(time_s), {time_s, time_s >= from_s ? jump_m : 0.0, 0.0}, graph);
  }
}

TEST(ToldPath, WhereNothingJumpsTheKeyframesDo) {
  const SlamGraph graph = straight(5);
  ToldPath told;
  tell(told, graph, 4.0, 9.0, 0.0);
  told.end(graph);
  EXPECT_EQ(told.key_poses(graph).size(), 5u);
}

TEST(ToldPath, BothSidesOfAJumpAreKeyPosesOnTheSolvedPath) {
  SlamGraph graph = straight(5);
  ToldPath told;
  tell(told, graph, 4.0, 1.75, 98.0);
  for (Keyframe& k : graph.keyframes) {  // solved: another speed, another way
    k.T_map_base = on_line(1.2 * k.T_map_base.x());
  }
  const auto poses = told.key_poses(graph);
  ASSERT_EQ(poses.size(), 7u);
  EXPECT_TRUE(std::is_sorted(poses.begin(), poses.end(),
                             [](const auto& a, const auto& b) { return a.utime < b.utime; }));
  for (const PoseEstimate& pose : poses) {
    const double time_s = 1e-6 * static_cast<double>(pose.utime);
    const Eigen::Vector3d is = on_line(1.2 * time_s);
    EXPECT_NEAR(pose.x_m, is.x(), 1e-9);
    EXPECT_NEAR(pose.y_m, is.y(), 1e-9);
    EXPECT_NEAR(pose.yaw_rad, is.z(), 1e-9);
    EXPECT_NEAR(pose.covariance[0], 1.0 + time_s, 1e-9);
  }
  EXPECT_EQ(poses[2].utime, 1'500'000);
  EXPECT_EQ(poses[3].utime, 1'750'000);
}

TEST(ToldPath, OnePoseOfSeveralAtOneTimeIsTold) {
  const SlamGraph graph = straight(3);
  ToldPath told;
  told.tell(place_at(0.5), {0.5, 0.0, 0.0}, graph);
  told.tell(place_at(0.5), {0.5, 98.0, 0.0}, graph);  // by then corrected
  told.tell(place_at(0.75), {0.75, 98.0, 0.0}, graph);
  told.end(graph);
  EXPECT_EQ(told.key_poses(graph).size(), 3u);
}

TEST(ToldPath, AJumpOntoTheCorrectedPastIsNone) {
  const SlamGraph graph = straight(3);
  ToldPath told;
  told.tell(place_at(0.5), {0.5, 98.0, 0.0}, graph);
  told.tell(place_at(0.75), {0.75, 0.0, 0.0}, graph);
  told.correct(graph);  // at 0.75 s: the pose at 0.5 s is now where the graph has it
  told.end(graph);
  EXPECT_EQ(told.key_poses(graph).size(), 3u);
}

TEST(ToldPath, AHeadingJumpsToo) {
  const SlamGraph graph = straight(3);
  ToldPath told;
  told.tell(place_at(1.25), {1.25, 0.0, 3.1}, graph);
  told.tell(place_at(1.5), {1.0, 0.0, -3.1}, graph);  // on by 0.25 m, turned across pi
  told.end(graph);
  EXPECT_EQ(told.key_poses(graph).size(), 5u);
}

}  // namespace
}  // namespace orchard::pose
