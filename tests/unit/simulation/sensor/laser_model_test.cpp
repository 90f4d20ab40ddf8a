// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor/laser_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::simulation {
namespace {

World one_cylinder(double x_m, double y_m, double radius_m) {
  World world;
  Cylinder cylinder;
  cylinder.x_m = x_m;
  cylinder.y_m = y_m;
  cylinder.radius_m = radius_m;
  cylinder.height_m = 2.0;
  world.cylinders.push_back(cylinder);
  world.num_targets = 1;
  return world;
}

ScannerConfig perfect() {
  ScannerConfig scanner;
  scanner.beam_sd_m = scanner.beam_sd_fraction = 0.0;
  scanner.scan_sd_fraction = scanner.target_sd_fraction = 0.0;
  scanner.dropout_probability = 0.0;
  scanner.resolution_m = 1e-6;
  return scanner;
}

/// A scan of one upright cylinder whose surface is range_m away, at a random bearing within +-60
/// degrees.
laser::Scan simulate_trunk_scan(double diameter_m, double range_m, const ScannerConfig& scanner,
                                Random& random) {
  const double bearing_rad = random.uniform(-geometry::kPi / 3.0, geometry::kPi / 3.0);
  World world;
  world.num_targets = 1;
  Cylinder trunk;
  trunk.radius_m = 0.5 * diameter_m;
  trunk.x_m = (range_m + trunk.radius_m) * std::cos(bearing_rad);
  trunk.y_m = (range_m + trunk.radius_m) * std::sin(bearing_rad);
  trunk.height_m = scanner.height_m + 1.0;
  world.cylinders.push_back(trunk);
  const std::vector<double> errors = draw_target_errors(1, scanner, random);
  return simulate_scan(world, {Pose2{}}, scanner, errors, random);
}

TEST(LaserModel, HasTheAnglesOfTheDataSheet) {
  const laser::Scan scan = simulate_perfect_scan({}, {}, {});
  ASSERT_EQ(scan.ranges_m.size(), 683u);
  EXPECT_NEAR(scan.bearing_step_rad * 180.0 / geometry::kPi, 360.0 / 1024.0, 1e-12);
  EXPECT_NEAR(scan.bearing_rad(0), -scan.bearing_rad(682), 1e-12);
  EXPECT_NEAR((scan.bearing_rad(682) - scan.bearing_rad(0)) * 180.0 / geometry::kPi, 240.0, 0.36);
  EXPECT_NEAR(scan.bearing_rad(341), 0.0, 1e-12);
}

// A ray at angle a to the centre's direction meets a circle at d cos a - sqrt(r^2 - d^2 sin^2 a).
TEST(LaserModel, RangesToACylinderAreThoseOfTheCircle) {
  const double distance_m = 2.0, bearing_rad = 0.4, radius_m = 0.115;
  const Pose2 pose{1.0, -2.0, 0.7};
  const World world =
      one_cylinder(pose.x_m + distance_m * std::cos(pose.yaw_rad + bearing_rad),
                   pose.y_m + distance_m * std::sin(pose.yaw_rad + bearing_rad), radius_m);
  const laser::Scan scan = simulate_perfect_scan(world, pose, {});
  int num_hits = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double a = scan.bearing_rad(static_cast<double>(i)) - bearing_rad;
    const double inside = radius_m * radius_m - std::pow(distance_m * std::sin(a), 2);
    if (inside < 0.0 || std::abs(a) > 1.0) {
      EXPECT_EQ(scan.ranges_m[i], 0.0f) << i;
    } else {
      EXPECT_NEAR(scan.ranges_m[i], distance_m * std::cos(a) - std::sqrt(inside), 1e-6) << i;
      ++num_hits;
    }
  }
  EXPECT_NEAR(num_hits, 2.0 * std::asin(radius_m / distance_m) / scan.bearing_step_rad, 1.0);
}

TEST(LaserModel, SpotsAddNothingToAnIsolatedCylinder) {
  Random random(3);
  for (const double range_m : {0.5, 1.0, 2.0, 4.0}) {
    double sum = 0.0;
    constexpr int kScans = 400;
    ScannerConfig scanner = perfect();
    for (int i = 0; i < kScans; ++i) {
      const laser::Scan scan = simulate_trunk_scan(0.090, range_m, scanner, random);
      sum += static_cast<double>(std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                               [](float r) { return r > 0.0f; }));
    }
    // the mean number of beams on a cylinder is the angle it fills, in steps
    const double expected = 2.0 * std::asin(0.045 / (range_m + 0.045)) / scanner.bearing_step_rad;
    EXPECT_NEAR(sum / kScans, expected, 0.12) << range_m;
  }
}

TEST(LaserModel, SpotsThatReturnFromAnyPartMakeThingsASpotWider) {
  Random random(3);
  ScannerConfig scanner = perfect();
  scanner.spot_m = 0.010;
  scanner.spot_rad = 0.003;
  scanner.return_fraction = 0.1;
  for (const double range_m : {0.5, 1.0, 2.0, 4.0}) {
    double sum = 0.0;
    constexpr int kScans = 400;
    for (int i = 0; i < kScans; ++i) {
      const laser::Scan scan = simulate_trunk_scan(0.090, range_m, scanner, random);
      sum += static_cast<double>(std::count_if(scan.ranges_m.begin(), scan.ranges_m.end(),
                                               [](float r) { return r > 0.0f; }));
    }
    // eight ninths of the spot: rays at ninths of it, and one of nine is enough
    const double centre_m = range_m + 0.045, spot_m = (0.010 + 0.003 * centre_m) * 8.0 / 9.0;
    const double angle_rad = 2.0 * std::asin(0.045 / centre_m) + spot_m / centre_m;
    EXPECT_NEAR(sum / kScans, angle_rad / scanner.bearing_step_rad, 0.15) << range_m;
  }
}

TEST(LaserModel, NearerThingsHideFartherOnes) {
  World world = one_cylinder(2.0, 0.0, 0.05);
  world.cylinders.push_back(one_cylinder(3.0, 0.0, 0.30).cylinders[0]);
  const laser::Scan scan = simulate_perfect_scan(world, {}, {});
  EXPECT_NEAR(scan.ranges_m[341], 1.95, 1e-6);
  EXPECT_NEAR(scan.ranges_m[341 + 8], 2.72, 0.03);
}

TEST(LaserModel, SpotsOnAnEdgeReadBetweenTwoSurfaces) {
  World world = one_cylinder(1.5, 0.0, 0.05);
  world.cylinders.push_back(one_cylinder(3.0, 0.0, 0.50).cylinders[0]);
  world.num_targets = 1;
  ScannerConfig scanner = perfect();
  scanner.mixed_probability = 1.0;
  Random random(1);
  int num_between = 0;
  for (int i = 0; i < 50; ++i) {
    const double yaw_rad = 0.0001 * i;
    for (const float r : simulate_scan(world, {{0, 0, yaw_rad}}, scanner, {}, random).ranges_m) {
      if (r > 1.60f && r < 2.40f) ++num_between;
    }
  }
  EXPECT_GT(num_between, 10);
  EXPECT_LE(num_between, 100);  // at most one at each edge
  scanner.mixed_probability = 0.0;
  for (const float r : simulate_scan(world, {Pose2{}}, scanner, {}, random).ranges_m) {
    EXPECT_FALSE(r > 1.60f && r < 2.40f) << r;
  }
}

// The error of the middle beam, over many targets: within the class limit, and neither far
// smaller than it nor larger than its third.
TEST(LaserModel, RangeErrorsKeepTheClassLimit) {
  const ScannerConfig scanner;
  for (const double range_m : {0.5, 1.0, 2.5, 3.9}) {
    Random random(17);
    double sum = 0.0, sum_squares = 0.0;
    int n = 0;
    for (int i = 0; i < 500; ++i) {
      World world = one_cylinder(range_m + 0.2, 0.0, 0.2);
      const auto errors = draw_target_errors(1, scanner, random);
      const float measured_m =
          simulate_scan(world, {Pose2{}}, scanner, errors, random).ranges_m[341];
      if (measured_m == 0.0f) continue;
      const double error_m = measured_m - range_m;
      const double limit_m = range_m < 1.0 ? 0.030 : 0.03 * range_m;
      EXPECT_LE(std::abs(error_m), limit_m + 0.001);
      sum += error_m;
      sum_squares += error_m * error_m;
      ++n;
    }
    const double sd_m = std::sqrt(sum_squares / n);
    EXPECT_NEAR(sum / n, 0.0, 4.0 * sd_m / std::sqrt(n));
    EXPECT_GT(sd_m, 0.003 * range_m);
    EXPECT_LT(sd_m, std::max(0.030, 0.03 * range_m) / 3.0);
  }
}

TEST(LaserModel, RangesAreWholeMillimetresAndEndAtTheRangeLimit) {
  Random random(5);
  World world = one_cylinder(3.0, 0.5, 0.4);
  world.cylinders.push_back(one_cylinder(0.0, 6.5, 0.4).cylinders[0]);
  for (const float r : simulate_scan(world, {Pose2{}}, {}, {}, random).ranges_m) {
    EXPECT_NEAR(r * 1000.0, std::round(r * 1000.0), 1e-3);
    EXPECT_LE(r, 5.6f);
  }
}

TEST(LaserModel, AMovingScannerSeesEveryBeamFromWhereItWasThen) {
  ScannerConfig scanner = perfect();
  const World world = one_cylinder(3.0, 0.0, 0.2);
  std::vector<Pose2> poses;
  for (int i = 0; i < scanner.num_beams; ++i) poses.push_back({0.001 * i, 0.0, 0.0});
  Random random(1);
  const laser::Scan scan = simulate_scan(world, poses, scanner, {}, random);
  EXPECT_NEAR(scan.ranges_m[341], 3.0 - 0.2 - 0.341, 1e-3);
  EXPECT_THROW(simulate_scan(world, std::vector<Pose2>(2), scanner, {}, random),
               std::invalid_argument);
}

}  // namespace
}  // namespace orchard::simulation
