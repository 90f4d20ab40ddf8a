// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/park/park_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

TEST(ParkScene, HoldsWhatItsConfigurationSays) {
  ParkConfig config;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const Scene scene = make_park_scene(seed, config);
    int num_trees = 0;
    for (const TruthObject& thing : scene.truth) {
      if (thing.label != detection::Label::kTree) continue;
      ++num_trees;
      EXPECT_GE(thing.width_m, config.trunk_width_min_m);
      EXPECT_LE(thing.width_m, config.trunk_width_max_m);
    }
    EXPECT_EQ(num_trees, config.num_trees);
    EXPECT_EQ(static_cast<int>(scene.truth.size()), config.num_trees + config.num_bushes);
    EXPECT_NEAR(scene.path.length_m(), config.way_m, 0.1);
    EXPECT_NEAR(scene.path.duration_s(), config.way_m / config.speed_mps, 0.1);
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        EXPECT_GE(std::hypot(scene.truth[i].x_m - scene.truth[j].x_m,
                             scene.truth[i].y_m - scene.truth[j].y_m),
                  config.trees_apart_m);
      }
    }
  }
}

TEST(ParkScene, TheCarDrivesAsACarClearOfTrunksAndStaysThere) {
  ParkConfig config;
  for (const std::uint64_t seed : {4u, 5u}) {
    const Scene scene = make_park_scene(seed, config);
    double before_radps = 0.0;
    for (double t_s = 0.1; t_s < scene.path.duration_s(); t_s += 0.1) {
      const Pose2 pose = scene.path.pose_at(t_s);
      const double rate_radps = scene.path.yaw_rate_at(t_s);
      EXPECT_LE(std::abs(rate_radps), config.speed_mps / config.turn_radius_m + 1e-9);
      // lock to lock in about three seconds
      EXPECT_LE(std::abs(rate_radps - before_radps), 0.15);
      before_radps = rate_radps;
      EXPECT_LE(std::abs(pose.x_m), 0.5 * config.length_m + 4.0 * config.turn_radius_m);
      EXPECT_LE(std::abs(pose.y_m), 0.5 * config.width_m + 4.0 * config.turn_radius_m);
      for (const TruthObject& thing : scene.truth) {
        EXPECT_GE(std::hypot(thing.x_m - pose.x_m, thing.y_m - pose.y_m),
                  1.9 + 0.5 * thing.width_m);
      }
    }
  }
}

/// Loops are what a park is for: places seen again, driven through in other directions.
TEST(ParkScene, TheCarComesBackFromOtherDirections) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const DrivePath path = make_park_scene(seed, {}).path;
    std::vector<Pose2> poses;
    for (double t_s = 0.0; t_s < path.duration_s(); t_s += 1.0) poses.push_back(path.pose_at(t_s));
    int num_back = 0, num_other = 0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      bool back = false, other = false;
      for (std::size_t j = 0; j + 60 < i; ++j) {
        if (std::hypot(poses[i].x_m - poses[j].x_m, poses[i].y_m - poses[j].y_m) > 10.0) continue;
        back = true;
        other |= std::abs(geometry::wrap_angle_rad(poses[i].yaw_rad - poses[j].yaw_rad)) > 1.0;
      }
      num_back += back;
      num_other += other;
    }
    EXPECT_GT(num_back, static_cast<int>(poses.size()) / 4) << "seed " << seed;
    EXPECT_GT(num_other, static_cast<int>(poses.size()) / 8) << "seed " << seed;
  }
}

}  // namespace
}  // namespace orchard::simulation
