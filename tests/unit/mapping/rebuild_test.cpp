// SPDX-License-Identifier: BSD-3-Clause
// Truth: a row of trunks at known places, seen on a drive whose poses drift, then are corrected.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <random>

#include "geometry/angles.hpp"
#include "mapping/mapper.hpp"
#include "mapping/pose_track.hpp"

namespace orchard::mapping {
namespace {

constexpr int kNumTrees = 12;
constexpr double kSpacing_m = 3.0;
constexpr double kReach_m = 6.0;

Eigen::Vector2d tree(int k) { return {kSpacing_m * k, 2.0}; }

/// Up the row and back again; true poses.
std::vector<pose::PoseEstimate> there_and_back() {
  std::vector<pose::PoseEstimate> poses;
  for (int i = 0; i <= 140; ++i) {
    pose::PoseEstimate pose;
    pose.utime = 100000 * i;
    pose.x_m = i <= 70 ? 0.5 * i : 0.5 * (140 - i);
    pose.yaw_rad = i <= 70 ? 0.0 : geometry::kPi;
    pose.covariance = {1e-4, 0, 0, 1e-4, 0, 1e-5};
    poses.push_back(pose);
  }
  return poses;
}

/// The same as dead reckoning tells them: ever farther off to the side, 2.8 m at the end.
pose::PoseEstimate drifted(pose::PoseEstimate pose) {
  pose.y_m += 2e-7 * static_cast<double>(pose.utime);
  pose.covariance = {0.05, 0, 0, 0.05, 0, 1e-4};
  return pose;
}

detection::Detections seen_from(const pose::PoseEstimate& pose, std::mt19937_64& random) {
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  const auto noise_m = [&] { return 0.02 * (static_cast<double>(random() % 2001) / 1000.0 - 1.0); };
  detection::Detections detections;
  detections.utime = pose.utime;
  for (int k = 0; k < kNumTrees; ++k) {
    const Eigen::Vector2d d = tree(k) - Eigen::Vector2d(pose.x_m, pose.y_m);
    if (d.norm() > kReach_m) continue;
    detection::Detection trunk;
    trunk.utime = pose.utime;
    trunk.centre_x_m = c * d.x() + s * d.y() + noise_m();
    trunk.centre_y_m = -s * d.x() + c * d.y() + noise_m();
    trunk.covariance = {2e-4, 0, 2e-4};
    trunk.width_m = 0.12;
    trunk.width_sd_m = 0.01;
    trunk.roc_tree = 0.9f;
    trunk.label = detection::Label::kTree;
    detections.trunks.push_back(trunk);
  }
  return detections;
}

struct Drive {
  Mapper mapper{MapperConfig{}};
  PoseTrack track{2.0};
  pose::Trajectory trajectory;
};

Drive drive() {
  Drive d;
  std::mt19937_64 random(5);
  const auto poses = there_and_back();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    d.track.add(drifted(poses[i]));
    d.mapper.update(seen_from(poses[i], random), drifted(poses[i]));
    if (i % 10 == 0) d.trajectory.poses.push_back(poses[i]);
  }
  d.trajectory.utime = poses.back().utime + 1;
  return d;
}

MapUpdate correct(Drive& d) {
  d.track.correct(d.trajectory);
  return d.mapper.rebuild(
      [&](const pose::PoseEstimate& was) { return d.track.at(was.utime).value(); });
}

TEST(Rebuild, ADriftedDriveBecomesOneLandmarkPerTree) {
  Drive d = drive();
  ASSERT_GT(d.mapper.num_landmarks(), static_cast<std::size_t>(kNumTrees));  // doubled by drift
  const std::size_t num_observations = d.mapper.num_observations();
  const MapUpdate update = correct(d);
  EXPECT_EQ(d.mapper.num_landmarks(), static_cast<std::size_t>(kNumTrees));
  EXPECT_EQ(d.mapper.num_observations(), num_observations);
  std::map<int, int> num_at_tree;
  for (const Landmark& l : d.mapper.landmarks()) {
    const int k = static_cast<int>(std::lround(l.x_m / kSpacing_m));
    ++num_at_tree[k];
    EXPECT_LT((Eigen::Vector2d(l.x_m, l.y_m) - tree(k)).norm(), 0.01);
  }
  EXPECT_EQ(num_at_tree.size(), static_cast<std::size_t>(kNumTrees));
  EXPECT_EQ(update.changed_ids.size(), static_cast<std::size_t>(kNumTrees));
  EXPECT_FALSE(update.removed_ids.empty());
}

TEST(Rebuild, ALandmarkHasTheIdOfItsLargestPart) {
  Drive d = drive();
  std::map<std::int32_t, int> num_before;
  for (const Landmark& l : d.mapper.landmarks()) num_before[l.id] = l.num_observations;
  correct(d);
  for (const Landmark& l : d.mapper.landmarks()) {
    ASSERT_TRUE(num_before.count(l.id)) << "id " << l.id << " is new";
    // Passed twice, and drift of 0.2 m/s parted each pass in two at most.
    EXPECT_GE(4 * num_before[l.id], l.num_observations) << "id " << l.id;
  }
}

TEST(Rebuild, WithoutACorrectionNothingChanges) {
  Drive d = drive();
  const std::vector<Landmark> before = d.mapper.landmarks();
  const MapUpdate update = d.mapper.rebuild([](const pose::PoseEstimate& was) { return was; });
  const std::vector<Landmark> after = d.mapper.landmarks();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].id, before[i].id);
    EXPECT_EQ(after[i].num_observations, before[i].num_observations);
    EXPECT_NEAR(after[i].x_m, before[i].x_m, 1e-5);  // observations are kept as floats
    EXPECT_NEAR(after[i].y_m, before[i].y_m, 1e-5);
    EXPECT_NEAR(after[i].width_m, before[i].width_m, 1e-5);
    EXPECT_EQ(after[i].label, before[i].label);
  }
  EXPECT_TRUE(update.removed_ids.empty());
}

TEST(Rebuild, TheMapGoesOnAfterIt) {
  Drive d = drive();
  correct(d);
  std::mt19937_64 random(6);
  for (pose::PoseEstimate pose : there_and_back()) {
    pose.utime += 20000000;
    d.mapper.update(seen_from(pose, random), pose);
  }
  EXPECT_EQ(d.mapper.num_landmarks(), static_cast<std::size_t>(kNumTrees));
  EXPECT_THROW(d.mapper.landmark(100000), std::out_of_range);
}

}  // namespace
}  // namespace orchard::mapping
