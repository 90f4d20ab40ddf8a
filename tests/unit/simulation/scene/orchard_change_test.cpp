// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/orchard_change.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/scene/clutter.hpp"
#include "simulation/scene/orchard_scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {
namespace {

SimulationConfig block() {
  SimulationConfig config;
  config.orchard.num_rows = 8;
  config.orchard.trees_per_row = 25;
  config.clutter.num_crates = 3;
  config.clutter.num_people = 2;
  config.clutter.twin_fraction = 0.05;
  return config;
}

Scene scene_of(const SimulationConfig& config, std::uint64_t seed) {
  Scene scene = make_orchard_scene(seed, config.orchard);
  add_clutter(seed, config, scene);
  change_orchard(seed, config.change, scene);
  return scene;
}

bool tree(const TruthObject& thing) { return thing.label == detection::Label::kTree; }

/// The thing of a truth that stands nearest to a place.
double distance_to_nearest_m(const std::vector<TruthObject>& truth, const TruthObject& thing) {
  double nearest_m = 1e9;
  for (const TruthObject& other : truth) {
    nearest_m = std::min(nearest_m, std::hypot(other.x_m - thing.x_m, other.y_m - thing.y_m));
  }
  return nearest_m;
}

int count_elsewhere(const std::vector<TruthObject>& of, const std::vector<TruthObject>& in) {
  return static_cast<int>(std::count_if(of.begin(), of.end(), [&](const TruthObject& thing) {
    return distance_to_nearest_m(in, thing) > 1e-9;
  }));
}

TEST(OrchardChange, FellsAndPlantsTheFractionAndLeavesTheRest) {
  SimulationConfig config = block();
  const Scene before = scene_of(config, 5);
  const auto num_trees = std::count_if(before.truth.begin(), before.truth.end(), tree);
  config.change.fraction = 0.05;
  const Scene after = scene_of(config, 5);
  const int wanted = static_cast<int>(std::lround(0.05 * num_trees));
  ASSERT_GT(wanted, 5);
  EXPECT_EQ(count_elsewhere(before.truth, after.truth), wanted);
  EXPECT_EQ(count_elsewhere(after.truth, before.truth), wanted);
  EXPECT_EQ(before.truth.size(), after.truth.size());
  for (const TruthObject& thing : after.truth) {
    // what is new stands in an empty place of a row
    if (distance_to_nearest_m(before.truth, thing) > 1e-9) {
      EXPECT_TRUE(tree(thing));
      EXPECT_LT(distance_to_nearest_m(before.gaps, thing), 1e-9);
    }
  }
}

TEST(OrchardChange, NumbersEverythingAnew) {
  SimulationConfig config = block();
  config.change.fraction = 0.1;
  config.change.growth_m = 0.01;
  const Scene scene = scene_of(config, 6);
  ASSERT_EQ(scene.world.num_targets, static_cast<int>(scene.truth.size()));
  ASSERT_EQ(scene.former_targets.size(), scene.truth.size());
  ASSERT_EQ(scene.people.size(), 2u);
  for (const Cylinder& c : scene.world.cylinders) {
    if (c.target < 0) continue;
    const TruthObject& thing = scene.truth[c.target];
    EXPECT_LE(std::hypot(c.x_m - thing.x_m, c.y_m - thing.y_m), 0.5 * thing.width_m);
    if (tree(thing)) {
      EXPECT_NEAR(2.0 * c.radius_m, thing.width_m, 1e-12);
    }
  }
  for (const Box& box : scene.world.boxes) {
    EXPECT_EQ(box.x_m, scene.truth[box.target].x_m);
  }
  for (const Person& person : scene.people) {
    EXPECT_TRUE(scene.truth[person.target].moving);
    EXPECT_EQ(scene.truth[person.target].x_m, person.x_m);
  }
  // the same thing keeps its lasting error: former numbers point at the unchanged scene
  config.change = {};
  const Scene before = scene_of(config, 6);
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    const auto former = static_cast<std::size_t>(scene.former_targets[i]);
    if (former >= before.truth.size()) continue;
    EXPECT_EQ(before.truth[former].x_m, scene.truth[i].x_m);
    EXPECT_EQ(before.truth[former].y_m, scene.truth[i].y_m);
  }
}

TEST(OrchardChange, TrunksGrowAndMoveAsFarAsConfigured) {
  SimulationConfig config = block();
  config.clutter = {};
  const Scene before = scene_of(config, 7);
  config.change.growth_m = 0.012;
  const Scene grown = scene_of(config, 7);
  double sum_m = 0.0;
  int num_trees = 0;
  for (std::size_t i = 0; i < before.truth.size(); ++i) {
    const double wider_m = grown.truth[i].width_m - before.truth[i].width_m;
    EXPECT_EQ(grown.truth[i].x_m, before.truth[i].x_m);
    if (!tree(before.truth[i])) {
      EXPECT_EQ(wider_m, 0.0);
      continue;
    }
    EXPECT_GE(wider_m, -1e-12);
    sum_m += wider_m;
    ++num_trees;
  }
  EXPECT_NEAR(sum_m / num_trees, 0.012, 4.0 * 0.003 / std::sqrt(num_trees));

  config.change = {};
  config.change.moved_fraction = 0.1;
  config.change.moved_m = 0.7;
  const Scene moved = scene_of(config, 7);
  int num_moved = 0;
  for (std::size_t i = 0; i < before.truth.size(); ++i) {
    const double way_m = std::hypot(moved.truth[i].x_m - before.truth[i].x_m,
                                    moved.truth[i].y_m - before.truth[i].y_m);
    if (way_m == 0.0) continue;
    EXPECT_NEAR(way_m, 0.7, 1e-9);
    ++num_moved;
  }
  EXPECT_NEAR(num_moved, 0.1 * num_trees, 1.0);
}

TEST(OrchardChange, SomeGrowSomeMoveSomePostsAndBushesStandElsewhere) {
  SimulationConfig config = block();
  config.clutter.num_people = 0;
  const Scene before = scene_of(config, 9);
  config.change.moved_fraction = 0.1;
  config.change.moved_m = 0.5;
  config.change.moved_spread_m = 1.0;
  config.change.growth_m = 0.04;
  config.change.grown_fraction = 0.1;
  config.change.objects_fraction = 0.5;
  const Scene after = scene_of(config, 9);
  ASSERT_EQ(before.truth.size(), after.truth.size());
  int num_moved = 0, num_grown = 0, num_trees = 0, num_objects = 0, num_elsewhere = 0;
  double farthest_m = 0.0;
  for (std::size_t i = 0; i < before.truth.size(); ++i) {
    const TruthObject &then = before.truth[i], &now = after.truth[i];
    const double way_m = std::hypot(now.x_m - then.x_m, now.y_m - then.y_m);
    if (!tree(then)) {
      ++num_objects;
      num_elsewhere += way_m > 0.0;
      continue;
    }
    ++num_trees;
    if (way_m > 0.0) {
      ++num_moved;
      EXPECT_GE(way_m, 0.5 - 1e-9);
      EXPECT_LE(way_m, 1.5);
      farthest_m = std::max(farthest_m, way_m);
    }
    if (now.width_m != then.width_m) {
      ++num_grown;
      EXPECT_EQ(way_m, 0.0) << "one thing at a time";
      EXPECT_NEAR(now.width_m - then.width_m, 0.04, 0.04);
    }
  }
  EXPECT_NEAR(num_moved, 0.1 * num_trees, 1.0);
  EXPECT_NEAR(num_grown, 0.1 * num_trees, 1.0);
  EXPECT_NEAR(num_elsewhere, 0.5 * num_objects, 1.0);
  EXPECT_GT(farthest_m, 1.0);
  for (const Cylinder& c : after.world.cylinders) {
    const TruthObject& thing = after.truth[static_cast<std::size_t>(c.target)];
    EXPECT_LE(std::hypot(c.x_m - thing.x_m, c.y_m - thing.y_m), 0.5 * thing.width_m);
  }
  for (const Box& box : after.world.boxes) {
    EXPECT_EQ(box.x_m, after.truth[static_cast<std::size_t>(box.target)].x_m);
  }
}

TEST(OrchardChange, AnotherSeedChangesOthers) {
  SimulationConfig config = block();
  config.change.fraction = 0.05;
  const Scene one = scene_of(config, 8);
  const Scene again = scene_of(config, 8);
  config.change.seed = 2;
  const Scene two = scene_of(config, 8);
  EXPECT_EQ(count_elsewhere(one.truth, again.truth), 0);
  EXPECT_GT(count_elsewhere(one.truth, two.truth), 5);
}

}  // namespace
}  // namespace orchard::simulation
