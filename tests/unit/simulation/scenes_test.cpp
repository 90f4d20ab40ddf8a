// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/simulation_config.hpp"
#include "unit/simulation/rig.hpp"

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

OrchardConfig block(int num_rows, int laps) {
  OrchardConfig config;
  config.num_rows = num_rows;
  config.trees_per_row = 6;
  config.laps = laps;
  return config;
}

void expect_pose(const Pose2& pose, double x_m, double y_m, double yaw_rad) {
  EXPECT_NEAR(pose.x_m, x_m, 1e-6);
  EXPECT_NEAR(pose.y_m, y_m, 1e-6);
  EXPECT_NEAR(geometry::wrap_angle_rad(pose.yaw_rad - yaw_rad), 0.0, 1e-6);
}

TEST(OrchardPath, EveryLapEndsWhereItBegan) {
  for (const int num_rows : {2, 3, 4, 5, 10}) {
    for (const double headland_m : {2.0, 3.0, 7.0}) {
      OrchardConfig config = block(num_rows, 3);
      config.headland_m = headland_m;
      const DrivePath path = make_orchard_path(1, config, {});
      const double lap_s = path.duration_s() / 3.0;
      for (int lap = 0; lap <= 3; ++lap) {
        expect_pose(path.pose_at(lap * lap_s), 0.0, 0.0, geometry::kPi / 2.0);
      }
      config.laps = 1;
      EXPECT_NEAR(make_orchard_path(1, config, {}).duration_s(), lap_s, 1e-9);
    }
  }
}

TEST(OrchardPath, GoesRoundSmoothlyThroughEveryAisleAndClearOfEverything) {
  for (const int num_rows : {4, 5}) {
    const Scene scene = make_orchard_scene(7, block(num_rows, 1));
    ASSERT_FALSE(scene.stepped);
    constexpr double kStep_s = 0.05;
    const double middle_m = kRowsBegin_m + 5.0;
    std::set<long> aisles;
    Pose2 before = scene.path.pose_at(0.0);
    for (double t_s = kStep_s; t_s < scene.path.duration_s(); t_s += kStep_s) {
      const Pose2 now = scene.path.pose_at(t_s);
      EXPECT_NEAR(std::hypot(now.x_m - before.x_m, now.y_m - before.y_m), kStep_s, 1e-4);
      const double turn_rad = geometry::wrap_angle_rad(now.yaw_rad - before.yaw_rad);
      EXPECT_LE(std::abs(turn_rad), 0.5 * kStep_s + 1e-9);
      const double heading_rad = std::atan2(now.y_m - before.y_m, now.x_m - before.x_m);
      EXPECT_LT(std::abs(geometry::wrap_angle_rad(heading_rad - now.yaw_rad)), 0.02);
      if ((before.y_m - middle_m) * (now.y_m - middle_m) < 0.0) {
        EXPECT_NEAR(std::remainder(now.x_m, 4.0), 0.0, 1e-6);
        aisles.insert(std::lround(now.x_m / 4.0));
      }
      for (const TruthObject& thing : scene.truth) {
        EXPECT_GT(std::hypot(thing.x_m - now.x_m, thing.y_m - now.y_m), 0.5 * thing.width_m + 0.5);
      }
      before = now;
    }
    // an odd number of aisles is closed outside of the first row
    const std::set<long> wanted =
        num_rows == 4 ? std::set<long>{-1, 0, 1, 2} : std::set<long>{0, 1, 2, 3};
    EXPECT_EQ(aisles, wanted);
  }
}

TEST(OrchardPath, StartsAnywhereOnTheSameLap) {
  const OrchardConfig fixed = block(5, 1);
  OrchardConfig config = block(5, 2);
  config.start_anywhere = true;
  const DrivePath lap = make_orchard_path(1, fixed, {});
  std::set<long> places;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const DrivePath path = make_orchard_path(seed, config, {});
    EXPECT_NEAR(path.duration_s(), 2.0 * lap.duration_s(), 1e-9);
    const double begin_s = path.way_at(0.0);
    EXPECT_GE(begin_s, 0.0);
    EXPECT_LT(begin_s, lap.duration_s());
    places.insert(std::lround(begin_s));
    for (const double t_s : {0.0, 20.0, 90.0}) {
      const Pose2 wanted = lap.pose_at(std::fmod(begin_s + t_s, lap.duration_s()));
      expect_pose(path.pose_at(t_s), wanted.x_m, wanted.y_m, wanted.yaw_rad);
    }
    const Pose2 start = path.pose_at(0.0);
    expect_pose(path.pose_at(path.duration_s()), start.x_m, start.y_m, start.yaw_rad);
  }
  EXPECT_GT(places.size(), 20u);
}

TEST(OrchardPath, IsCarriedIntoAnotherAisleAndDrivesOnThere) {
  const OrchardConfig config = block(6, 1);
  const DrivePath plain = make_orchard_path(1, config, {});
  CarryConfig carry;
  carry.at_s = 8.0;  // in the first aisle
  carry.for_s = 6.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    carry.to_aisle = seed <= 10 ? 0 : 3;
    const DrivePath path = make_orchard_path(seed, config, carry);
    expect_pose(path.pose_at(8.0), 0.0, 8.0, geometry::kPi / 2.0);
    EXPECT_FALSE(path.carried_at(7.9));
    EXPECT_TRUE(path.carried_at(8.1));
    EXPECT_TRUE(path.carried_at(13.9));
    EXPECT_FALSE(path.carried_at(14.1));
    const Pose2 down = path.pose_at(14.0);
    const long aisle = std::lround(down.x_m / 4.0);
    EXPECT_GE(aisle, 1);
    if (carry.to_aisle == 3) {
      EXPECT_EQ(aisle, 2);
    }
    EXPECT_NEAR(down.x_m, 4.0 * aisle, 1e-6);
    EXPECT_NEAR(std::sin(down.yaw_rad), aisle % 2 == 0 ? 1.0 : -1.0, 1e-6);
    const double way_m = path.way_at(14.0);
    for (const double t_s : {15.0, 40.0, path.duration_s()}) {
      const Pose2 wanted = plain.pose_at(way_m + t_s - 14.0);
      expect_pose(path.pose_at(t_s), wanted.x_m, wanted.y_m, wanted.yaw_rad);
    }
    expect_pose(path.pose_at(path.duration_s()), 0.0, 0.0, geometry::kPi / 2.0);
    // no jolt: it moves continuously through the air
    for (double t_s = 7.9; t_s < 14.1; t_s += 0.01) {
      const Pose2 a = path.pose_at(t_s), b = path.pose_at(t_s + 0.01);
      EXPECT_LT(std::hypot(b.x_m - a.x_m, b.y_m - a.y_m), 0.12);
      EXPECT_NEAR(geometry::wrap_angle_rad(b.yaw_rad - a.yaw_rad),
                  0.01 * path.yaw_rate_at(t_s + 0.005), 2e-3);
    }
  }
}

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
  ASSERT_EQ(scene.movers.size(), 2u);
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
  for (const Mover& person : scene.movers) {
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
  double farthest_m = 0.0, sum_grown_m = 0.0;
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
      sum_grown_m += now.width_m - then.width_m;
    }
  }
  EXPECT_NEAR(num_moved, 0.1 * num_trees, 1.0);
  EXPECT_NEAR(num_grown, 0.1 * num_trees, 1.0);
  EXPECT_NEAR(sum_grown_m / num_grown, 0.04, 4.0 * 0.01 / std::sqrt(num_grown));
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

TEST(TubeScene, IsThePapers) {
  const Scene scene = make_tube_scene(7, test_rig());
  ASSERT_EQ(scene.truth.size(), 16u);
  ASSERT_EQ(scene.world.cylinders.size(), 16u);
  for (int i = 0; i < 12; ++i) {
    EXPECT_EQ(scene.truth[i].name, "T" + std::to_string(i + 1));
    EXPECT_EQ(scene.truth[i].label, detection::Label::kTree);
    EXPECT_DOUBLE_EQ(scene.truth[i].width_m, 0.090);
    EXPECT_DOUBLE_EQ(scene.world.cylinders[i].height_m, 0.500);
    EXPECT_EQ(scene.truth[i].x_m > 0.0, i >= 6);
    EXPECT_NEAR(std::abs(scene.truth[i].x_m), 0.8, 0.041);
    const double hue_deg = scene.world.cylinders[i].appearance.hue_deg;
    EXPECT_GT(hue_deg, 17.6);
    EXPECT_LT(hue_deg, 44.6);
    if (i % 6 > 0) {
      EXPECT_NEAR(scene.truth[i].y_m - scene.truth[i - 1].y_m, 1.0, 0.081);
    }
  }
  for (int i = 12; i < 16; ++i) {
    EXPECT_EQ(scene.truth[i].name, "B" + std::to_string(i - 11));
    EXPECT_EQ(scene.truth[i].label, detection::Label::kObject);
    EXPECT_DOUBLE_EQ(scene.truth[i].width_m, i == 13 ? 0.090 : 0.170);
  }
  EXPECT_GT(scene.world.cylinders[13].appearance.hue_deg, 90.0);  // B2, another colour
}

TEST(TubeScene, RobotGoesMidwayInEqualSteps) {
  const Scene scene = make_tube_scene(7, test_rig());
  ASSERT_TRUE(scene.stepped);
  for (std::size_t i = 0; i < scene.stops.size(); ++i) {
    EXPECT_DOUBLE_EQ(scene.stops[i].x_m, 0.0);
    EXPECT_NEAR(scene.stops[i].y_m, 0.4 * static_cast<double>(i), 1e-12);
    EXPECT_DOUBLE_EQ(scene.stops[i].yaw_rad, geometry::kPi / 2.0);
  }
}

TEST(TubeScene, EverythingIsInFiveToEightPairs) {
  const RigConfig rig = test_rig();
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Scene scene = make_tube_scene(seed, rig);
    const std::vector<int> pairs = count_pairs(scene, rig, 4.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      EXPECT_GE(pairs[i], 5) << "seed " << seed << " " << scene.truth[i].name;
      EXPECT_LE(pairs[i], 8) << "seed " << seed << " " << scene.truth[i].name;
    }
  }
}

TEST(TubeScene, NothingStandsInAnotherOrInTheRobotsWay) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = make_tube_scene(seed, test_rig());
    for (std::size_t i = 0; i < scene.truth.size(); ++i) {
      EXPECT_GT(std::abs(scene.truth[i].x_m) - 0.5 * scene.truth[i].width_m, 0.2);
      for (std::size_t j = 0; j < i; ++j) {
        const double gap_m = std::hypot(scene.truth[i].x_m - scene.truth[j].x_m,
                                        scene.truth[i].y_m - scene.truth[j].y_m) -
                             0.5 * (scene.truth[i].width_m + scene.truth[j].width_m);
        EXPECT_GT(gap_m, 0.05) << "seed " << seed;
      }
    }
  }
}

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

std::vector<Pose2> way_of(const Scene& scene) {
  std::vector<Pose2> way;
  for (double s = 0.0; s <= scene.path.duration_s(); s += 0.5) way.push_back(scene.path.pose_at(s));
  return way;
}

TEST(YardScene, GivesRoomToARobotOnItsWay) {
  constexpr double kRobot_m = 0.6;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Scene scene = make_yard_scene(seed, {});
    EXPECT_NEAR(scene.path.length_m(), 1500.0, 60.0);
    for (const Pose2& pose : way_of(scene)) {
      for (const Cylinder& c : scene.world.cylinders) {
        ASSERT_GT(std::hypot(c.x_m - pose.x_m, c.y_m - pose.y_m), c.radius_m + kRobot_m)
            << "seed " << seed << " at " << pose.x_m << ", " << pose.y_m;
      }
      for (const Box& b : scene.world.boxes) {
        const Pose2 in_box = between(Pose2{b.x_m, b.y_m, b.yaw_rad}, pose);
        const double dx = std::abs(in_box.x_m) - 0.5 * b.length_m;
        const double dy = std::abs(in_box.y_m) - 0.5 * b.width_m;
        ASSERT_GT(std::hypot(std::max(dx, 0.0), std::max(dy, 0.0)), kRobot_m) << "seed " << seed;
      }
    }
  }
}

}  // namespace

}  // namespace orchard::simulation
