// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/world_index.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/scene/clutter.hpp"
#include "simulation/scene/moving_world.hpp"
#include "simulation/scene/orchard_scene.hpp"
#include "simulation/sensor/laser_model.hpp"

namespace orchard::simulation {
namespace {

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

TEST(WorldIndex, FindsAllWithinReachOnce) {
  World world;
  Random random(9);
  for (int i = 0; i < 500; ++i) {
    Cylinder c;
    c.x_m = random.uniform(-100.0, 100.0);
    c.y_m = random.uniform(-100.0, 100.0);
    c.radius_m = random.uniform(0.01, 2.0);
    world.cylinders.push_back(c);
  }
  const WorldIndex index(world);
  for (int i = 0; i < 100; ++i) {
    const double x_m = random.uniform(-120.0, 120.0), y_m = random.uniform(-120.0, 120.0);
    const double radius_m = random.uniform(0.0, 30.0);
    const auto found = index.cylinders_near(x_m, y_m, radius_m);
    for (std::size_t k = 1; k < found.size(); ++k) EXPECT_LT(found[k - 1], found[k]);
    for (std::size_t k = 0; k < world.cylinders.size(); ++k) {
      const Cylinder& c = world.cylinders[k];
      if (std::hypot(c.x_m - x_m, c.y_m - y_m) > radius_m + c.radius_m) continue;
      EXPECT_TRUE(std::binary_search(found.begin(), found.end(), k));
    }
  }
  EXPECT_TRUE(WorldIndex().cylinders_near(0.0, 0.0, 1e3).empty());
  EXPECT_TRUE(index.boxes_near(0.0, 0.0, 1e3).empty());
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
