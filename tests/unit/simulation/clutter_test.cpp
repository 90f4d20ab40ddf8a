// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/angles.hpp"
#include "simulation/scene/moving_world.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "simulation/simulator.hpp"
#include "unit/simulation/rig.hpp"
#include "worlds/observation_truth.hpp"

namespace orchard::simulation {
namespace {

RigConfig cluttered() {
  RigConfig rig = test_rig();
  rig.camera.enabled = false;
  rig.simulation.scanner.range_max_m = 20.0;
  rig.simulation.scanner.height_m = 0.5;
  rig.simulation.orchard.trees_per_row = 8;
  ClutterConfig& clutter = rig.simulation.clutter;
  clutter.trunk_post_fraction = 0.3;
  clutter.stake_fraction = 0.3;
  clutter.twin_fraction = 0.1;
  clutter.num_crates = 5;
  clutter.grass_per_tree = 3.0;
  clutter.twigs_per_tree = 2.0;
  clutter.sway_m = 0.02;
  clutter.num_branches = 3;
  clutter.num_people = 3;
  clutter.row_end_hedges = true;
  clutter.foliage = 0.4;
  return rig;
}

int count(const Scene& scene, char kind) {
  return static_cast<int>(
      std::count_if(scene.truth.begin(), scene.truth.end(),
                    [kind](const TruthObject& t) { return t.name[0] == kind; }));
}

TEST(Clutter, MovesNoTreeAndHoldsWhatIsAskedFor) {
  int num_posts = 0, num_trees = 0, num_people = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    RigConfig rig = cluttered();
    const Scene with = Simulator(SceneKind::kOrchard, seed, rig).scene();
    rig.simulation.clutter = {};
    const Scene plain = Simulator(SceneKind::kOrchard, seed, rig).scene();
    ASSERT_GT(with.truth.size(), plain.truth.size());
    for (std::size_t i = 0; i < plain.truth.size(); ++i) {
      EXPECT_EQ(with.truth[i].x_m, plain.truth[i].x_m);
      EXPECT_EQ(with.truth[i].width_m, plain.truth[i].width_m);
    }
    // every target is a place in the truth
    EXPECT_EQ(static_cast<std::size_t>(with.world.num_targets), with.truth.size());
    for (const Cylinder& c : with.world.cylinders) {
      ASSERT_LT(c.target, with.world.num_targets);
      if (c.target < 0 || with.truth[c.target].name[0] == 'S') continue;
      EXPECT_EQ(with.truth[c.target].x_m, c.x_m);
    }
    num_trees += count(plain, 'T');
    num_posts += count(with, 'P') - count(plain, 'P');
    num_people += static_cast<int>(with.movers.size());
    EXPECT_EQ(count(with, 'C'), 5);
    // nothing stands in the robot's way
    for (double t_s = 0.0; t_s < with.path.duration_s(); t_s += 0.2) {
      const Pose2 pose = with.path.pose_at(t_s);
      for (const TruthObject& thing : truth_at(with, t_s)) {
        EXPECT_GT(std::hypot(thing.x_m - pose.x_m, thing.y_m - pose.y_m), 0.6) << thing.name;
      }
    }
  }
  EXPECT_NEAR(static_cast<double>(num_posts) / num_trees, 0.3, 0.06);
  EXPECT_GE(num_people, 24);  // of 30; some find no free way
}

TEST(Clutter, PostsOfMaterialsStandWherePaintedOnesDo) {
  RigConfig rig = cluttered();
  rig.simulation.clutter.trunk_post_fraction = 0.0;
  const Scene painted = Simulator(SceneKind::kOrchard, 1, rig).scene();
  rig.simulation.clutter.post_materials = true;
  const Scene material = Simulator(SceneKind::kOrchard, 1, rig).scene();
  ASSERT_EQ(painted.world.cylinders.size(), material.world.cylinders.size());
  int num_posts = 0;
  for (std::size_t i = 0; i < painted.world.cylinders.size(); ++i) {
    const Cylinder &a = painted.world.cylinders[i], &b = material.world.cylinders[i];
    EXPECT_EQ(a.x_m, b.x_m);
    EXPECT_EQ(a.radius_m, b.radius_m);
    const bool is_post = a.target >= 0 && painted.truth[a.target].name[0] == 'P';
    num_posts += is_post ? 1 : 0;
    EXPECT_EQ(a.appearance.saturation == b.appearance.saturation, !is_post) << i;
    EXPECT_EQ(b.appearance.texture == Appearance::Texture::kWood &&
                  b.appearance.reflectivity != a.appearance.reflectivity,
              is_post);
  }
  EXPECT_GE(num_posts, 4);
}

TEST(Clutter, VehiclesStandUntilTheRobotComesAndLeaveTheirPlace) {
  int num_vehicles = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RigConfig rig = cluttered();
    rig.simulation.clutter.num_people = 0;
    rig.simulation.clutter.num_vehicles = 1;
    rig.simulation.orchard.num_rows = 5;
    const Simulator simulator(SceneKind::kOrchard, seed, rig);
    const Scene& scene = simulator.scene();
    num_vehicles += static_cast<int>(scene.movers.size());
    for (const Mover& vehicle : scene.movers) {
      const auto place = [&](double time_s) {
        return truth_at(scene, time_s)[static_cast<std::size_t>(vehicle.target)];
      };
      EXPECT_TRUE(place(0.0).moving);
      EXPECT_EQ(place(vehicle.starts_s).x_m, place(0.0).x_m);
      EXPECT_EQ(place(vehicle.starts_s).y_m, vehicle.y_m);
      const double a_y_m = place(vehicle.starts_s + 10.0).y_m;
      const double b_y_m = place(vehicle.starts_s + 12.0).y_m;
      EXPECT_NEAR(std::abs(b_y_m - a_y_m), 2.0 * vehicle.speed_mps, 0.01);
      for (double t_s = 0.0; t_s < scene.path.duration_s(); t_s += 0.2) {
        const Pose2 robot = scene.path.pose_at(t_s);
        const TruthObject now = place(t_s);
        EXPECT_GT(std::hypot(now.x_m - robot.x_m, now.y_m - robot.y_m), 2.5);
        int num_boxes = 0;
        for (const Box& box : world_at(scene, t_s).boxes) {
          if (box.target != vehicle.target) continue;
          ++num_boxes;
          EXPECT_LT(std::hypot(box.x_m - now.x_m, box.y_m - now.y_m), 1.0);
        }
        EXPECT_EQ(num_boxes, 5);
      }
    }
  }
  EXPECT_GE(num_vehicles, 3);
}

TEST(Clutter, PeopleWalkAndTheTruthWalksWithThem) {
  RigConfig rig = cluttered();
  rig.simulation.clutter.person_speed_mps = 1.3;
  const Simulator simulator(SceneKind::kOrchard, 2, rig);
  const Scene& scene = simulator.scene();
  ASSERT_FALSE(scene.movers.empty());
  const auto before = truth_at(scene, 10.0), after = truth_at(scene, 12.0);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double way_m = std::hypot(after[i].x_m - before[i].x_m, after[i].y_m - before[i].y_m);
    if (before[i].moving) {
      EXPECT_GT(way_m, 2.0 * 1.3 * 0.79);
      EXPECT_LT(way_m, 2.0 * 1.3 * 1.21);
    } else {
      EXPECT_EQ(way_m, 0.0);
    }
  }
  // each leg stays within a step of the body, whose place the truth gives
  for (double t_s = 0.0; t_s < 3.0; t_s += 0.1) {
    const auto truth = truth_at(scene, t_s);
    for (const Cylinder& c : world_at(scene, t_s).cylinders) {
      if (c.target < 0 || !truth[c.target].moving) continue;
      EXPECT_LT(std::hypot(c.x_m - truth[c.target].x_m, c.y_m - truth[c.target].y_m), 0.35);
    }
  }
  // no truth of a map holds them, but scans do
  for (const TruthObject& thing : simulator.truth()) EXPECT_FALSE(thing.moving);
  std::map<int, double> first_x_m, first_y_m, way_m;
  for (std::int64_t scan = 0; scan < simulator.num_scans(); scan += 5) {
    for (const TrueObservation& o : true_observations(simulator, cluttered(), scan)) {
      if (!scene.truth[o.object].moving) continue;
      EXPECT_EQ(o.label, detection::Label::kObject);
      first_x_m.emplace(o.object, o.x_m);
      first_y_m.emplace(o.object, o.y_m);
      way_m[o.object] = std::max(
          way_m[o.object], std::hypot(o.x_m - first_x_m[o.object], o.y_m - first_y_m[o.object]));
    }
  }
  ASSERT_FALSE(way_m.empty());
  for (const auto& [object, metres] : way_m) EXPECT_GT(metres, 1.0) << object;
}

// Every return of a crate lies on one of the four sides of its rectangle.
TEST(Clutter, CratesAreRectanglesInTheScan) {
  World world;
  world.num_targets = 1;
  Box crate;
  crate.x_m = 2.0;
  crate.y_m = 0.7;
  crate.yaw_rad = -0.2;
  crate.length_m = 1.2;
  crate.width_m = 0.8;
  crate.height_m = 1.0;
  world.boxes.push_back(crate);
  const Pose2 pose{0.2, -0.3, 0.25};
  const laser::Scan scan = simulate_perfect_scan(world, pose, {});
  int num_sides[4] = {0, 0, 0, 0};
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (scan.ranges_m[i] <= 0.0f) continue;
    const double a = pose.yaw_rad + scan.bearing_rad(static_cast<double>(i));
    const double ex = pose.x_m + scan.ranges_m[i] * std::cos(a) - crate.x_m;
    const double ey = pose.y_m + scan.ranges_m[i] * std::sin(a) - crate.y_m;
    const double along_m = std::cos(-0.2) * ex + std::sin(-0.2) * ey;
    const double across_m = -std::sin(-0.2) * ex + std::cos(-0.2) * ey;
    EXPECT_LE(std::abs(along_m), 0.6 + 1e-5);
    EXPECT_LE(std::abs(across_m), 0.4 + 1e-5);
    const double off[4] = {along_m + 0.6, 0.6 - along_m, across_m + 0.4, 0.4 - across_m};
    const auto* side = std::min_element(std::begin(off), std::end(off));
    EXPECT_NEAR(*side, 0.0, 1e-5);
    ++num_sides[side - off];
  }
  EXPECT_GT(num_sides[0], 10);  // the two sides that face the scanner, not the two behind
  EXPECT_GT(num_sides[2], 10);
  EXPECT_EQ(num_sides[1] + num_sides[3], 0);
}

TEST(Clutter, ReflectorsStandOutAndATiltedPlaneMeetsTheGround) {
  ScannerConfig scanner;
  scanner.intensities = true;
  scanner.height_m = 0.3;
  World world;
  world.num_targets = 2;
  for (const double y_m : {-1.0, 1.0}) {
    Cylinder trunk;
    trunk.x_m = 2.0;
    trunk.y_m = y_m;
    trunk.radius_m = 0.1;
    trunk.height_m = 1.0;
    trunk.target = y_m > 0 ? 1 : 0;
    trunk.appearance.reflectivity = y_m > 0 ? 8.0 : 0.3;
    world.cylinders.push_back(trunk);
  }
  Random random(1);
  const laser::Scan level = simulate_scan(world, {Pose2{}}, scanner, {}, random);
  ASSERT_EQ(level.intensities.size(), level.ranges_m.size());
  double most[2] = {0.0, 0.0};
  for (std::size_t i = 0; i < level.ranges_m.size(); ++i) {
    if (level.ranges_m[i] == 0.0f) {
      EXPECT_EQ(level.intensities[i], 0.0f);
    }
    double& strongest = most[level.bearing_rad(static_cast<double>(i)) > 0.0];
    strongest = std::max<double>(strongest, level.intensities[i]);
  }
  EXPECT_GT(most[1], 10.0 * most[0]);
  // nose down by 0.1 rad from 0.3 m: the ground lies 3.0 m ahead, and nothing behind
  const laser::Scan tilted = simulate_scan(world, {Pose2{}}, scanner, {}, random, {0.1, 0.0});
  EXPECT_NEAR(tilted.ranges_m[341], 3.0, 0.1);
  EXPECT_EQ(tilted.ranges_m[20], 0.0f);
}

TEST(Clutter, StopAndGoWeaveAndLateStampsAreParameters) {
  RigConfig rig = cluttered();
  rig.simulation.clutter = {};
  rig.simulation.orchard.weave_radps = 0.5;
  rig.simulation.orchard.weave_period_s = 3.0;
  const Simulator weaving(SceneKind::kOrchard, 1, rig);
  const DrivePath& path = weaving.scene().path;
  double most_radps = 0.0;
  for (double t_s = 0.0; t_s < 18.0; t_s += 0.05) {  // the first aisle
    const double rate =
        geometry::wrap_angle_rad(path.pose_at(t_s + 0.01).yaw_rad - path.pose_at(t_s).yaw_rad) /
        0.01;
    most_radps = std::max(most_radps, std::abs(rate));
    EXPECT_LT(std::abs(path.pose_at(t_s).x_m), 0.25);
  }
  EXPECT_NEAR(most_radps, 0.5, 0.06);
  rig.simulation.orchard.weave_radps = 0.0;
  rig.simulation.orchard.stop_every_m = 0.5;
  Simulator stopping(SceneKind::kOrchard, 1, rig);
  const auto poses = stopping.true_poses();
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_NEAR(std::hypot(poses[i].x_m - poses[i - 1].x_m, poses[i].y_m - poses[i - 1].y_m), 0.5,
                1e-9);
    EXPECT_EQ(poses[i].utime - poses[i - 1].utime, 500000);
  }
}

// A picture stamped 50 ms late at one time is the picture stamped rightly 50 ms before.
TEST(Clutter, ALateStampNamesALaterTimeForTheSamePicture) {
  RigConfig rig = cluttered();
  rig.camera.enabled = true;
  rig.simulation.image.rate_hz = 20.0;
  rig.simulation.image.offset_s = 0.0;
  rig.simulation.image.noise_sd = 0.0;
  const auto pictures = [&] {
    std::map<std::int64_t, std::vector<std::uint8_t>> result;
    Simulator simulator(SceneKind::kOrchard, 3, rig);
    while (result.size() < 4) {
      const auto message = simulator.next();
      if (const auto* image = std::get_if<vision::Image>(&*message)) {
        result[image->utime] = image->data;
      }
    }
    return result;
  };
  const auto right = pictures();
  rig.simulation.image.stamp_delay_s = 0.05;
  auto late = pictures();
  for (const std::int64_t after_us : {0, 50000, 100000}) {
    EXPECT_EQ(late.at(kEpochUtime + after_us + 50000), right.at(kEpochUtime + after_us));
  }
  EXPECT_NE(right.at(kEpochUtime), right.at(kEpochUtime + 50000));
}

TEST(WorldIndex, ScansOfWhatIsNearAreScansOfTheWholeWorld) {
  SimulationConfig config;
  config.orchard.num_rows = 12;
  config.orchard.trees_per_row = 40;
  config.clutter.grass_per_tree = 2.0;
  config.clutter.sway_m = 0.05;
  config.clutter.num_crates = 10;
  config.clutter.num_people = 3;
  config.clutter.row_end_hedges = true;
  config.scanner.range_max_m = 12.0;
  Scene scene = make_orchard_scene(3, config.orchard);
  add_clutter(3, config, scene);
  const WorldIndex index(scene.world);
  Random places(5);
  int num_returns = 0;
  for (int i = 0; i < 40; ++i) {
    const Pose2 laser{places.uniform(-5.0, 45.0), places.uniform(-3.0, 90.0),
                      places.uniform(-3.0, 3.0)};
    const double time_s = places.uniform(0.0, 500.0);
    const World near = world_near(scene, index, laser.x_m, laser.y_m, 14.0, time_s);
    EXPECT_LT(near.cylinders.size(), scene.world.cylinders.size() / 2);
    const auto wanted = simulate_perfect_scan(world_at(scene, time_s), laser, config.scanner);
    const auto got = simulate_perfect_scan(near, laser, config.scanner);
    EXPECT_EQ(got.ranges_m, wanted.ranges_m);
    for (const float range_m : got.ranges_m) num_returns += range_m > 0.0f;
  }
  EXPECT_GT(num_returns, 1000);
}

TEST(WorldIndex, TargetsOfALargeWorldErrAsThoseOfASmallOne) {
  // five thousand things, one before the laser: its error in each scan has the configured spread,
  // and is not that of its neighbour
  ScannerConfig scanner;
  scanner.beam_sd_m = scanner.beam_sd_fraction = scanner.target_sd_fraction = 0.0;
  scanner.scan_sd_fraction = 0.004;
  scanner.dropout_probability = 0.0;
  World world;
  world.num_targets = 5000;
  for (const double side : {-1.0, 1.0}) {
    Cylinder c;
    c.x_m = 4.0;
    c.y_m = 2.0 * side;
    c.radius_m = 0.1;
    c.height_m = 2.0;
    c.target = side < 0.0 ? 4321 : 4322;
    world.cylinders.push_back(c);
  }
  const auto perfect = simulate_perfect_scan(world, {}, scanner);
  double sum[2] = {0, 0}, squares[2] = {0, 0}, product = 0.0;
  constexpr int kScans = 800;
  for (int scan = 0; scan < kScans; ++scan) {
    Random random(1, Stream::kScan, static_cast<std::uint64_t>(scan));
    const auto seen = simulate_scan(world, {Pose2{}}, scanner, {}, random);
    double errors[2] = {0, 0};
    for (const int side : {0, 1}) {
      // the beam through its middle
      const double bearing_rad = (side == 0 ? -1.0 : 1.0) * std::atan2(2.0, 4.0);
      const auto beam = static_cast<std::size_t>(
          std::lround((bearing_rad - scanner.bearing_min_rad) / scanner.bearing_step_rad));
      errors[side] = seen.ranges_m[beam] / perfect.ranges_m[beam] - 1.0;
      sum[side] += errors[side];
      squares[side] += errors[side] * errors[side];
    }
    product += errors[0] * errors[1];
  }
  for (const int side : {0, 1}) {
    EXPECT_NEAR(sum[side] / kScans, 0.0, 6e-4);
    EXPECT_NEAR(std::sqrt(squares[side] / kScans), 0.004, 4e-4);
  }
  EXPECT_NEAR(product / kScans, 0.0, 2.5e-6);
}

}  // namespace

}  // namespace orchard::simulation
