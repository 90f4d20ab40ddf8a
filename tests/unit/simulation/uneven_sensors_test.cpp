// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/simulator.hpp"

namespace orchard::simulation {
namespace {

ScannerConfig perfect() {
  ScannerConfig scanner;
  scanner.beam_sd_m = scanner.beam_sd_fraction = 0.0;
  scanner.scan_sd_fraction = scanner.target_sd_fraction = 0.0;
  scanner.dropout_probability = scanner.mixed_probability = 0.0;
  scanner.spot_rad = 0.0;
  scanner.resolution_m = 1e-6;
  scanner.range_max_m = 30.0;
  scanner.height_m = 0.5;
  return scanner;
}

World one_trunk(double x_m, double y_m, double radius_m) {
  World world;
  Cylinder trunk{x_m, y_m, radius_m, 2.0, 0.0, 0, {}};
  world.cylinders.push_back(trunk);
  world.num_targets = 1;
  return world;
}

laser::Scan scan_of(const World& world, const Terrain& terrain, const Pose3& T_map_laser,
                    const ScannerConfig& scanner, double grass_m = 0.0, int seed = 1) {
  Random random(static_cast<std::uint64_t>(seed));
  return simulate_scan(world, UnevenSweep{terrain, grass_m, {T_map_laser.transform()}}, scanner, {},
                       random);
}

constexpr std::size_t kAhead = 341;

TEST(UnevenScan, OnLevelGroundIsTheLevelScan) {
  World world = one_trunk(2.0, 0.5, 0.06);
  world.boxes.push_back({-1.5, 2.0, 0.4, 1.2, 1.0, 0.76, 0.0, 0, {}});
  world.cylinders.push_back({1.0, -1.5, 0.3, 0.9, 0.0, 0, {}});
  world.cylinders.push_back({1.0, -3.0, 0.3, 0.4, 0.0, 0, {}});  // below the scan
  const ScannerConfig scanner = perfect();
  const Terrain terrain;
  const laser::Scan uneven = scan_of(world, terrain, {{0.1, 0.2, 0.3}, 0.5}, scanner);
  const laser::Scan level = simulate_perfect_scan(world, {0.1, 0.2, 0.3}, scanner);
  int num_hits = 0;
  for (std::size_t i = 0; i < level.ranges_m.size(); ++i) {
    EXPECT_NEAR(uneven.ranges_m[i], level.ranges_m[i], 2e-6) << i;
    num_hits += level.ranges_m[i] > 0.0f;
  }
  EXPECT_GT(num_hits, 100);
}

// half a metre above the ground, tilted by 3 degrees: 0.5 / sin(3 deg) = 9.55 m
TEST(UnevenScan, ATiltedBeamMeetsTheGround) {
  const double pitch_rad = 3.0 * geometry::kPi / 180.0;
  const laser::Scan scan = scan_of({}, {}, {{}, 0.5, pitch_rad, 0.0}, perfect());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    const double down = std::sin(pitch_rad) * std::cos(bearing_rad);
    const double wanted_m = down > 0.5 / 29.9 ? 0.5 / down : 0.0;
    if (down > 0.5 / 30.1 && down < 0.5 / 29.9) continue;
    EXPECT_NEAR(scan.ranges_m[i], wanted_m, 2e-4) << i;
  }
  EXPECT_NEAR(scan.ranges_m[kAhead], 9.55, 0.01);
}

TEST(UnevenScan, MeetsBumpsWhereTheBeamIsAtTheirHeight) {
  TerrainConfig config;
  config.slope_along_percent = 25.0;
  config.roughness_m3 = 16384e-6;
  config.terrace_height_m = 0.4;
  const Terrain terrain(4, config);
  const Pose3 pose{{0.0, 0.0, 1.2}, terrain.height_m(0.0, 0.0) + 0.5, 0.02, 0.01};
  const Eigen::Isometry3d T_map_laser = pose.transform();
  const laser::Scan scan = scan_of({}, terrain, pose, perfect());
  int num_hits = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double bearing_rad = scan.bearing_rad(static_cast<double>(i));
    const double range_m = scan.ranges_m[i] > 0.0f ? scan.ranges_m[i] : 29.0;
    const auto height_m = [&](double at_m) {
      const Eigen::Vector3d p = T_map_laser * Eigen::Vector3d(at_m * std::cos(bearing_rad),
                                                              at_m * std::sin(bearing_rad), 0.0);
      return p.z() - terrain.height_m(p.x(), p.y());
    };
    if (scan.ranges_m[i] > 0.0f) {
      EXPECT_NEAR(height_m(range_m), 0.0, 1e-3) << i;
      ++num_hits;
    }
    // nothing nearer is below the ground, but for tips that a step of 8 cm passes
    for (double at_m = 0.0; at_m < range_m - 0.01; at_m += 0.01) EXPECT_GT(height_m(at_m), -0.02);
  }
  EXPECT_GT(num_hits, 200);
}

TEST(UnevenScan, MeetsLeaningTaperingTrunksWhereItPassesThem) {
  World world = one_trunk(4.0, 0.0, 0.10);
  world.cylinders[0].lean_x = 0.1;
  world.cylinders[0].taper = 0.03;
  const ScannerConfig scanner = perfect();
  // a beam ahead that rises by 0.1 m per metre: the trunk's near side at height 0.5 + h is at
  // 4 + 0.1 h - (0.10 - 0.03 h), which the beam reaches at x = h / 0.1
  const double pitch_rad = -std::atan(0.1);
  const double x_m = (4.0 - 0.10) / (1.0 - 0.1 * (0.1 + 0.03));
  const laser::Scan scan = scan_of(world, {}, {{}, 0.5, pitch_rad, 0.0}, scanner);
  EXPECT_NEAR(scan.ranges_m[kAhead], x_m / std::cos(pitch_rad), 1e-5);
  // above its top of 2 m it passes
  EXPECT_EQ(scan_of(world, {}, {{}, 0.5, -0.45, 0.0}, scanner).ranges_m[kAhead], 0.0f);
}

TEST(UnevenScan, TrunksUpASlopeStandOnIt) {
  TerrainConfig config;
  config.slope_across_percent = 25.0;
  const Terrain terrain(1, config);
  // the ground is at 0.25 x; a level beam at 0.5 m meets it at 2 m, before a trunk at 4 m
  const World world = one_trunk(4.0, 0.0, 0.1);
  EXPECT_NEAR(scan_of(world, terrain, {{}, 0.5}, perfect()).ranges_m[kAhead], 2.0, 1e-3);
  // parallel to the ground it meets the trunk
  const double up_rad = -std::atan(0.25);
  EXPECT_NEAR(scan_of(world, terrain, {{}, 0.5, up_rad}, perfect()).ranges_m[kAhead],
              3.9 / std::cos(up_rad), 1e-4);
}

// Beer-Lambert: beside beams that meet the soil, the way in grass has an exponential distribution
// of mean height / (0.5 * 1.7)
TEST(UnevenScan, GrassReturnsBeamsAfterAnExponentialWay) {
  const double grass_m = 0.2, pitch_rad = 0.2;
  double sum_m = 0.0;
  int num_grass = 0, num_soil = 0;
  const double soil_m = 0.5 / std::sin(pitch_rad), top_m = (0.5 - grass_m) / std::sin(pitch_rad);
  for (int seed = 1; seed <= 4000; ++seed) {
    const laser::Scan scan = scan_of({}, {}, {{}, 0.5, pitch_rad, 0.0}, perfect(), grass_m, seed);
    const double range_m = scan.ranges_m[kAhead];
    EXPECT_GE(range_m, top_m - 1e-6);
    EXPECT_LE(range_m, soil_m + 1e-3);
    const bool is_soil = range_m > soil_m - 1e-3;
    (is_soil ? num_soil : num_grass) += 1;
    sum_m += range_m - top_m;
  }
  const double mean_m = grass_m / (0.5 * 1.7), way_m = soil_m - top_m;
  const double through = std::exp(-way_m / mean_m);
  EXPECT_NEAR(num_soil / 4000.0, through, 0.02);
  EXPECT_NEAR(sum_m / 4000.0, mean_m * (1.0 - through), 0.01);
}

RigConfig hill() {
  RigConfig rig;
  rig.camera.enabled = false;
  SimulationConfig& config = rig.simulation;
  config.orchard.num_rows = 3;
  config.orchard.trees_per_row = 4;
  config.orchard.fix_rate_hz = 0.0;
  config.scanner = perfect();
  config.scanner.rate_hz = 1.0;
  config.imu.rate_hz = 20.0;
  config.imu.orientation = true;
  config.terrain.slope_along_percent = 20.0;
  config.terrain.slope_across_percent = 10.0;
  return rig;
}

template <class Message>
std::vector<Message> messages_of(const RigConfig& rig, std::uint64_t seed = 1) {
  Simulator simulator(SceneKind::kOrchard, seed, rig);
  std::vector<Message> all;
  while (const auto message = simulator.next()) {
    if (const auto* wanted = std::get_if<Message>(&*message)) all.push_back(*wanted);
  }
  return all;
}

double seconds(std::int64_t utime) { return static_cast<double>(utime - kEpochUtime) * 1e-6; }

// Both ways to cast rays, past trunks, crates, branches and walking people, from a moving scanner:
// a billionth of a radian off the level is not flat, and moves no range by a micrometre.
TEST(UnevenDrive, OnLevelGroundSeesWhatALevelDriveSees) {
  RigConfig rig = hill();
  rig.simulation.terrain = {};
  rig.simulation.orchard.weave_radps = 0.4;
  rig.simulation.clutter.num_crates = 5;
  rig.simulation.clutter.num_branches = 6;
  rig.simulation.clutter.num_people = 3;
  rig.simulation.clutter.grass_per_tree = 5.0;
  const auto level = messages_of<laser::Scan>(rig);
  rig.simulation.terrain.laser_pitch_rad = 1e-9;
  const auto uneven = messages_of<laser::Scan>(rig);
  ASSERT_EQ(uneven.size(), level.size());
  int num_hits = 0, num_others = 0;
  for (std::size_t scan = 0; scan < level.size(); ++scan) {
    for (std::size_t i = 0; i < level[scan].ranges_m.size(); ++i) {
      const float wanted_m = level[scan].ranges_m[i];
      num_hits += wanted_m > 0.0f;
      num_others += !(std::abs(uneven[scan].ranges_m[i] - wanted_m) < 5e-6f);
    }
  }
  EXPECT_GT(num_hits, 5000);
  EXPECT_EQ(num_others, 0);
}

TEST(UnevenDrive, TruthStandsOnTheGround) {
  const RigConfig rig = hill();
  Simulator simulator(SceneKind::kOrchard, 1, rig);
  EXPECT_FALSE(simulator.is_level());
  for (const TruthObject& thing : simulator.truth()) {
    EXPECT_NEAR(thing.z_m, 0.1 * thing.x_m + 0.2 * thing.y_m, 1e-9);
  }
  for (const TruePose& pose : simulator.true_poses()) {
    EXPECT_NEAR(pose.z_m, 0.1 * pose.x_m + 0.2 * pose.y_m, 1e-9);
  }
}

TEST(UnevenDrive, HorizontalPlacesAreThoseOfLevelGround) {
  RigConfig rig = hill();
  const Simulator uneven(SceneKind::kOrchard, 2, rig);
  rig.simulation.terrain = {};
  const Simulator level(SceneKind::kOrchard, 2, rig);
  ASSERT_EQ(uneven.truth().size(), level.truth().size());
  for (std::size_t i = 0; i < level.truth().size(); ++i) {
    EXPECT_EQ(uneven.truth()[i].x_m, level.truth()[i].x_m);
    EXPECT_EQ(uneven.truth()[i].width_m, level.truth()[i].width_m);
  }
}

// uphill along the rows at a horizontal 1 m/s
TEST(UnevenDrive, WheelsMeasureAlongTheSlope) {
  RigConfig rig = hill();
  rig.simulation.motion.speed_sd_mps = rig.simulation.motion.speed_scale_sd = 0.0;
  for (const pose::Odometry& odometry : messages_of<pose::Odometry>(rig)) {
    const double time_s = seconds(odometry.utime);
    if (time_s < 0.1 || time_s > 5.0) continue;
    EXPECT_NEAR(odometry.speed_mps, std::hypot(1.0, 0.2), 1e-6);
  }
}

// At constant speed straight up a slope the unit feels gravity only, in the axes of the body; its
// mean attitude error is that of the drift, which the run's own seed draws.
TEST(UnevenDrive, InertialUnitFeelsTheSlope) {
  const RigConfig rig = hill();
  const double uphill = 0.2, pitch_rad = -std::atan(uphill);
  const double roll_rad = std::atan(-0.1 * std::cos(pitch_rad));  // +x is to the right
  double force_mps2[3] = {0, 0, 0}, roll = 0.0, pitch = 0.0;
  int n = 0;
  for (const pose::Imu& imu : messages_of<pose::Imu>(rig)) {
    if (seconds(imu.utime) < 0.1 || seconds(imu.utime) > 5.0) continue;
    for (int axis = 0; axis < 3; ++axis) force_mps2[axis] += imu.acceleration_mps2[axis];
    roll += imu.roll_rad;
    pitch += imu.pitch_rad;
    ++n;
  }
  ASSERT_GT(n, 50);
  const Eigen::Vector3d normal = Eigen::Vector3d(-0.1, -uphill, 1.0).normalized();
  const double bias_mps2 = 0.2;  // four standard deviations of the bias
  EXPECT_NEAR(force_mps2[2] / n, 9.80665 * normal.z(), 0.05);
  EXPECT_NEAR(force_mps2[0] / n, -9.80665 * std::sin(pitch_rad), bias_mps2);
  EXPECT_NEAR(force_mps2[1] / n, 9.80665 * std::sin(roll_rad) * std::cos(pitch_rad), bias_mps2);
  EXPECT_NEAR(roll / n, roll_rad, 0.005);
  EXPECT_NEAR(pitch / n, pitch_rad, 0.005);
}

// The rates of a turn at constant yaw rate w on a slope: R^T of (0, 0, w) and of the attitude's own
// change; their size is that of the normal's share plus what turns the body about the slope.
TEST(UnevenDrive, RatesIntegrateToTheAttitude) {
  RigConfig rig = hill();
  rig.simulation.terrain.roughness_m3 = 256e-6;
  const TerrainConfig& terrain = rig.simulation.terrain;
  const WheeledBody body(Terrain(7, terrain), terrain);
  DrivePath path({0.0, 0.0, 0.5}, 1.0);
  path.append(12.0, 0.4);
  const double begin_s = 1.0, step_s = 0.001;
  Eigen::Matrix3d R = body.stand_at(path.pose_at(begin_s)).transform().linear();
  for (int i = 0; i < 8000; ++i) {
    const Eigen::Vector3d w = body.motion_at(path, begin_s + (i + 0.5) * step_s).angular_rate_radps;
    R = R * Eigen::AngleAxisd(w.norm() * step_s, w.normalized()).toRotationMatrix();
  }
  const Eigen::Matrix3d wanted = body.stand_at(path.pose_at(begin_s + 8.0)).transform().linear();
  EXPECT_LT(Eigen::AngleAxisd(R.transpose() * wanted).angle(), 2e-3);
}

TEST(UnevenDrive, SpecificForceIntegratesToTheClimb) {
  RigConfig rig = hill();
  rig.simulation.terrain.roughness_m3 = 256e-6;
  const TerrainConfig& terrain = rig.simulation.terrain;
  const WheeledBody body(Terrain(7, terrain), terrain);
  DrivePath path({0.0, 0.0, 0.5}, 1.0);
  path.append(12.0, 0.4);
  const auto at = [&](double s) { return body.stand_at(path.pose_at(s)).transform(); };
  const auto velocity = [&](double s) -> Eigen::Vector3d {
    return (at(s + 1e-4).translation() - at(s - 1e-4).translation()) / 2e-4;
  };
  Eigen::Vector3d gained = Eigen::Vector3d::Zero();
  constexpr double kStep_s = 0.001;
  for (double s = 1.0 + 0.5 * kStep_s; s < 6.0; s += kStep_s) {
    const Eigen::Vector3d force = at(s).linear() * body.motion_at(path, s).specific_force_mps2;
    gained += kStep_s * (force - Eigen::Vector3d(0.0, 0.0, 9.80665));
  }
  EXPECT_LT((gained - (velocity(6.0) - velocity(1.0))).norm(), 5e-3);
}

TEST(UnevenDrive, AttitudeDriftsAsConfigured) {
  RigConfig rig = hill();
  rig.simulation.terrain.slope_across_percent = 0.0;
  rig.simulation.imu.attitude_drift_sd_rad = 0.02;
  rig.simulation.imu.rate_hz = 1.0;
  rig.simulation.scanner.rate_hz = 0.1;
  double sum = 0.0;
  int n = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const InertialUnit unit(seed, rig.simulation.imu, 20.0, false);
    DrivePath path({0.0, 0.0, 0.5 * geometry::kPi}, 1.0);
    path.append(20.0, 0.0);
    const WheeledBody body(Terrain(1, rig.simulation.terrain), rig.simulation.terrain);
    sum += std::pow(unit.sample(path, 5, 5.0, body).roll_rad, 2);
    ++n;
  }
  EXPECT_NEAR(std::sqrt(sum / n), std::hypot(0.02, rig.simulation.imu.orientation_sd_rad), 0.002);
}

TEST(UnevenDrive, LowBranchesCrossThePlaneOfTheScan) {
  RigConfig rig = hill();
  rig.simulation.terrain.low_branches_per_tree = 3.0;
  rig.simulation.orchard.lean_sd_rad = 0.05;
  const Simulator with(SceneKind::kOrchard, 1, rig);
  rig.simulation.terrain.low_branches_per_tree = 0.0;
  const Simulator without(SceneKind::kOrchard, 1, rig);
  const auto& all = with.scene().world.cylinders;
  const std::size_t num_branches = all.size() - without.scene().world.cylinders.size();
  EXPECT_GT(num_branches, 20u);
  EXPECT_EQ(with.truth().size(), without.truth().size());
  const double scan_m = rig.simulation.scanner.height_m;
  for (std::size_t i = all.size() - num_branches; i < all.size(); ++i) {
    // its lower end is on the axis of a trunk
    const double begin_m = all[i].base_m - scan_m;
    const double x_m = all[i].x_m + begin_m * all[i].lean_x;
    const double y_m = all[i].y_m + begin_m * all[i].lean_y;
    EXPECT_TRUE(std::any_of(all.begin(), all.end() - static_cast<std::ptrdiff_t>(num_branches),
                            [&](const Cylinder& trunk) {
                              return std::hypot(trunk.x_m + begin_m * trunk.lean_x - x_m,
                                                trunk.y_m + begin_m * trunk.lean_y - y_m) < 1e-9;
                            }));
  }
}

}  // namespace
}  // namespace orchard::simulation
