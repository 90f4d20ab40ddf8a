// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/orchard_scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

int count(const Scene& scene, char kind) {
  return static_cast<int>(
      std::count_if(scene.truth.begin(), scene.truth.end(),
                    [kind](const TruthObject& t) { return t.name[0] == kind; }));
}

TEST(OrchardScene, HasRowsWithGapsPostsAndBushes) {
  int num_trees = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = make_orchard_scene(seed, {});
    num_trees += count(scene, 'T');
    EXPECT_EQ(count(scene, 'S'), 6);
    EXPECT_EQ(count(scene, 'P'), 4 * 3);
    for (const TruthObject& thing : scene.truth) {
      // the rows stand at -2, 2, 6 and 10 m
      const double off_m = std::remainder(thing.x_m - 2.0, 4.0);
      EXPECT_LT(std::abs(off_m), 0.21) << thing.name;
      EXPECT_EQ(thing.label == detection::Label::kTree, thing.name[0] == 'T');
    }
  }
  EXPECT_NEAR(num_trees / (20.0 * 60.0), 0.92, 0.025);  // 8 % are missing
}

TEST(OrchardScene, TrunksAreAsWideAsConfigured) {
  double sum = 0.0, sum_squares = 0.0;
  int n = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const TruthObject& thing : make_orchard_scene(seed, {}).truth) {
      if (thing.label != detection::Label::kTree) continue;
      sum += thing.width_m;
      sum_squares += thing.width_m * thing.width_m;
      ++n;
    }
  }
  EXPECT_NEAR(sum / n, 0.125, 0.002);
  EXPECT_NEAR(std::sqrt(sum_squares / n - std::pow(sum / n, 2)), 0.012, 0.002);
}

TEST(OrchardScene, RobotKeepsClearOfEverythingAndMovesSmoothly) {
  const Scene scene = make_orchard_scene(3, {});
  ASSERT_FALSE(scene.stepped);
  const double dt_s = 0.02;
  Pose2 before = scene.path.pose_at(0.0);
  double turned_rad = 0.0;
  for (double t_s = dt_s; t_s < scene.path.duration_s(); t_s += dt_s) {
    const Pose2 now = scene.path.pose_at(t_s);
    EXPECT_NEAR(std::hypot(now.x_m - before.x_m, now.y_m - before.y_m), dt_s, 1e-5);
    const double turn_rad = geometry::wrap_angle_rad(now.yaw_rad - before.yaw_rad);
    EXPECT_LE(std::abs(turn_rad), 0.5 * dt_s + 1e-9);
    // it goes where it looks
    const double heading_rad = std::atan2(now.y_m - before.y_m, now.x_m - before.x_m);
    EXPECT_LT(std::abs(geometry::wrap_angle_rad(heading_rad - now.yaw_rad)), 0.01);
    turned_rad += std::abs(turn_rad);
    for (const TruthObject& thing : scene.truth) {
      EXPECT_GT(std::hypot(thing.x_m - now.x_m, thing.y_m - now.y_m), 0.5 * thing.width_m + 0.5);
    }
    before = now;
  }
  EXPECT_NEAR(turned_rad, 2.0 * geometry::kPi, 0.01);  // two half circles between three alleys
}

TEST(DrivePath, ComposesAndFollowsArcs) {
  DrivePath path({1.0, 2.0, 0.0}, 2.0);
  path.append(4.0, 0.0);
  path.append(geometry::kPi * 3.0, 1.0 / 3.0);  // half a circle of 3 m to the left
  EXPECT_NEAR(path.duration_s(), (4.0 + geometry::kPi * 3.0) / 2.0, 1e-12);
  const Pose2 end = path.pose_at(path.duration_s() + 5.0);
  EXPECT_NEAR(end.x_m, 5.0, 1e-9);
  EXPECT_NEAR(end.y_m, 8.0, 1e-9);
  EXPECT_NEAR(std::abs(end.yaw_rad), geometry::kPi, 1e-9);
  EXPECT_NEAR(path.pose_at(1.0).x_m, 3.0, 1e-12);
}

}  // namespace
}  // namespace orchard::simulation
