// SPDX-License-Identifier: BSD-3-Clause
#include "pose/attitude/levelled_scan.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "geometry/angles.hpp"
#include "mapping/free_space.hpp"

namespace orchard::pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

laser::LaserConfig mount() {
  laser::LaserConfig config;
  config.mount_x_m = 0.4;
  config.mount_y_m = -0.1;
  config.mount_yaw_rad = 0.3;
  config.height_m = 0.5;
  return config;
}

/// A robot that stands tilted at the origin of a level world, whose ground passes through it.
struct Tilted {
  double roll_rad, pitch_rad;
  Matrix3d R() const {
    return (AngleAxisd(pitch_rad, Vector3d::UnitY()) * AngleAxisd(roll_rad, Vector3d::UnitX()))
        .toRotationMatrix();
  }
  Attitude attitude() const { return {roll_rad, pitch_rad, 0.0}; }
  Vector3d laser() const { return R() * Vector3d(0.4, -0.1, 0.5); }
  Vector3d ray(const laser::Scan& scan, std::size_t beam) const {
    const double bearing_rad =
        0.3 + scan.bearing_min_rad + static_cast<double>(beam) * scan.bearing_step_rad;
    return R() * Vector3d(std::cos(bearing_rad), std::sin(bearing_rad), 0.0);
  }
};

laser::Scan empty_scan() {
  laser::Scan scan;
  scan.bearing_min_rad = -2.0;
  scan.bearing_step_rad = 4.0 / 800;
  scan.range_min_m = 0.05;
  scan.range_max_m = 20.0;
  scan.ranges_m.assign(801, 0.0f);
  return scan;
}

/// Where a beam meets an upright pole: the horizontal place on its bark.
std::optional<double> range_to_pole(const Vector3d& from, const Vector3d& ray, const Vector2d& pole,
                                    double radius_m) {
  const Vector2d d = ray.head<2>(), to = from.head<2>() - pole;
  const double a = d.squaredNorm(), b = d.dot(to), c = to.squaredNorm() - radius_m * radius_m;
  if (b * b - a * c < 0.0) return std::nullopt;
  const double range_m = (-b - std::sqrt(b * b - a * c)) / a;
  if (range_m < 0.0 || range_m > 20.0) return std::nullopt;
  return range_m;
}

/// The plane that a robot knows after a long way on ground of this gradient.
GroundPlane driven(const Vector2d& gradient) {
  GroundPlane ground(5.0);
  const Attitude along{std::atan(gradient.y() * std::cos(std::atan(gradient.x()))),
                       -std::atan(gradient.x()), 0.0};
  for (int i = 0; i < 5000; ++i) ground.add(along, 0.01, 0.0);
  return ground;
}

Vector2d place_in_level_base(const laser::Scan& scan, std::size_t beam) {
  const double bearing_rad = 0.3 + scan.bearing_rad(static_cast<double>(beam));
  return Vector2d(0.4 + scan.sway_x_m, -0.1 + scan.sway_y_m) +
         scan.ranges_m[beam] * Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
}

TEST(ScanLeveller, PutsReturnsWhereTheirTreesStand) {
  const Vector2d pole(3.0, 1.0);
  for (const Tilted robot : {Tilted{0.2, -0.15}, Tilted{-0.25, 0.05}, Tilted{0.0, -0.24}}) {
    laser::Scan scan = empty_scan();
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const auto range_m = range_to_pole(robot.laser(), robot.ray(scan, i), pole, 0.06);
      if (range_m) scan.ranges_m[i] = static_cast<float>(*range_m);
    }
    // The robot stands on a slope as steep as its tilt: no beam meets the ground.
    ScanLeveller leveller(mount(), 0.1, 0.02);
    leveller.level(scan, robot.attitude(), robot.attitude(),
                   driven(gradient_under(robot.attitude())));
    int num = 0;
    for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
      if (!scan.valid(i)) continue;
      ++num;
      EXPECT_NEAR((place_in_level_base(scan, i) - pole).norm(), 0.06, 3e-6) << i;
    }
    EXPECT_GE(num, 6);
  }
}

TEST(ScanLeveller, LeavesTheScanOfALevelRobotAsItIs) {
  laser::Scan scan = empty_scan();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    scan.ranges_m[i] = i % 7 == 0 ? 0.0f : 1.0f + 0.005f * static_cast<float>(i);
  }
  const laser::Scan before = scan;
  ScanLeveller leveller(mount(), 0.1, 0.02);
  leveller.level(scan, {}, {}, driven({0.0, 0.0}));
  EXPECT_EQ(scan.sway_x_m, 0.0);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double beam = static_cast<double>(i);
    EXPECT_NEAR(scan.bearing_rad(beam), before.bearing_rad(beam), 2e-7);
    EXPECT_NEAR(scan.ranges_m[i], before.ranges_m[i], 1e-6);
    EXPECT_EQ(scan.beam_near(i), i);
  }
  EXPECT_NEAR(scan.bearing_rad(-0.5), before.bearing_rad(-0.5), 2e-7);
  EXPECT_NEAR(scan.bearing_rad(400.25), before.bearing_rad(400.25), 2e-7);
}

// A camera is fixed to the plane of the scan, not to the horizon.
TEST(ScanLeveller, PointsGoBackToThePlaneOfTheScan) {
  const Tilted robot{0.15, -0.2};
  laser::Scan scan = empty_scan();
  scan.ranges_m.assign(scan.ranges_m.size(), 3.0f);
  ScanLeveller leveller(mount(), 0.1, 0.02);
  leveller.level(scan, robot.attitude(), robot.attitude(),
                 driven(gradient_under(robot.attitude())));
  for (std::size_t i = 0; i < scan.ranges_m.size(); i += 10) {
    const double beam = static_cast<double>(i), bearing_rad = scan.bearing_rad(beam);
    const Vector2d back = scan.plane_of_level * scan.ranges_m[i] *
                          Vector2d(std::cos(bearing_rad), std::sin(bearing_rad));
    const double sent_rad = scan.bearing_min_rad + beam * scan.bearing_step_rad;
    EXPECT_LT((back - 3.0 * Vector2d(std::cos(sent_rad), std::sin(sent_rad))).norm(), 1e-5);
  }
}

// On a slope, nose down: so high above the ground are the returns, whatever the axes.
TEST(ScanLeveller, KnowsHowHighReturnsAreAboveTheGround) {
  const Vector2d gradient(0.1, -0.05);
  const Tilted robot{0.1, 0.08};
  laser::Scan scan = empty_scan();
  scan.ranges_m.assign(scan.ranges_m.size(), 1.5f);
  const laser::Scan sent = scan;
  ScanLeveller leveller(mount(), 0.1, 0.02);
  leveller.level(scan, robot.attitude(), robot.attitude(), driven(gradient));
  for (std::size_t i = 0; i < scan.ranges_m.size(); i += 10) {
    const Vector3d met = robot.laser() + 1.5 * robot.ray(sent, i);
    const double true_m = met.z() - gradient.dot(met.head<2>());
    const Vector2d arm = met.head<2>() - robot.laser().head<2>();
    const laser::OverGround& below = scan.over_ground;
    EXPECT_NEAR(below.height_m + below.per_x * arm.x() + below.per_y * arm.y(), true_m, 1e-4);
    const double sd_m = std::sqrt(below.variance_m2(static_cast<float>(arm.norm())));
    EXPECT_EQ(below.may_be_ground(static_cast<float>(arm.x()), static_cast<float>(arm.y())),
              true_m < 4.0 * sd_m);
  }
}

// Half a metre above the ground and nose down by 5 degrees: the ground is met at 5.7 m ahead, a
// pole at 2 m is not the ground, and one at 5.7 m cannot be told from it.
TEST(ScanLeveller, LeavesOutTheGroundAndKeepsTheTreeBeforeIt) {
  const Tilted robot{0.0, 5.0 * geometry::kPi / 180.0};
  laser::Scan scan = empty_scan();
  std::vector<int> what(scan.ranges_m.size(), 0);
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const Vector3d from = robot.laser(), ray = robot.ray(scan, i);
    double range_m = ray.z() < 0.0 ? -from.z() / ray.z() : 1e9;
    what[i] = range_m < 20.0 ? 1 : 0;
    const auto near_m = range_to_pole(from, ray, {2.4, 0.1}, 0.06);
    if (near_m && *near_m < range_m) range_m = *near_m, what[i] = 2;
    if (what[i] != 0) scan.ranges_m[i] = static_cast<float>(range_m);
  }
  ScanLeveller leveller(mount(), 0.1, 0.02);
  leveller.level(scan, robot.attitude(), robot.attitude(), driven({0.0, 0.0}));
  int num_ground = 0, num_pole = 0;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (what[i] != 0) {
      EXPECT_EQ(scan.valid(i), what[i] == 2) << i;
    }
    num_ground += what[i] == 1;
    num_pole += what[i] == 2;
  }
  EXPECT_GT(num_ground, 100);
  EXPECT_GT(num_pole, 10);
}

TEST(ScanLeveller, LeavesInTheGroundOfAScannerOfUnknownHeight) {
  laser::LaserConfig unknown = mount();
  unknown.height_m = 0.0;
  laser::Scan scan = empty_scan();
  scan.ranges_m.assign(scan.ranges_m.size(), 3.0f);
  ScanLeveller leveller(unknown, 0.1, 0.02);
  leveller.level(scan, {0.0, 0.1, 0.0}, {0.0, 0.1, 0.0}, driven({0.0, 0.0}));
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) EXPECT_TRUE(scan.valid(i)) << i;
  EXPECT_FALSE(scan.over_ground.is_known());
}

// What the beams of a tilted robot pass through, they pass through on the map: a wall behind a
// place that is free shows it free, at its true bearing.
TEST(ScanLeveller, FreeSpaceIsWhereTheBeamsWere) {
  const Tilted robot{0.2, 0.2};
  const Vector2d gap(-0.6, 3.0), pole(0.6, 3.0);
  laser::Scan scan = empty_scan();
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const Vector3d from = robot.laser(), ray = robot.ray(scan, i);
    const double wall_m = ray.y() > 0.1 ? (6.0 - from.y()) / ray.y() : 0.0;
    const auto pole_m = range_to_pole(from, ray, pole, 0.1);
    scan.ranges_m[i] = static_cast<float>(pole_m ? *pole_m : wall_m);
  }
  ScanLeveller leveller(mount(), 0.1, 0.02);
  leveller.level(scan, robot.attitude(), robot.attitude(),
                 driven(gradient_under(robot.attitude())));
  const mapping::FreeSpace seen(scan, mount(), {});
  EXPECT_EQ(seen.at(gap, 0.2, 0.01).evidence, mapping::FreeSpaceEvidence::kPassesThrough);
  EXPECT_EQ(seen.at(pole, 0.2, 0.01).evidence, mapping::FreeSpaceEvidence::kReturns);
  // beside the pole, by half a degree more than its own width
  for (const double side_m : {-0.19, 0.19}) {
    EXPECT_EQ(seen.at(pole + Vector2d(side_m, 0.0), 0.08, 0.001).evidence,
              mapping::FreeSpaceEvidence::kPassesThrough);
  }
}

TEST(GroundPlane, StaysInPlaceWhileTheRobotTurns) {
  const Vector2d gradient(0.15, -0.08);
  GroundPlane ground(5.0);
  double heading_rad = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double turn_rad = i < 1000 ? 0.0 : geometry::kPi / 1000;
    heading_rad += turn_rad;
    const Vector2d along = Eigen::Rotation2Dd(-heading_rad) * gradient;
    const double pitch_rad = -std::atan(along.x());
    ground.add({std::atan(along.y() * std::cos(pitch_rad)), pitch_rad, 0.0}, 0.05, turn_rad);
  }
  EXPECT_LT((ground.gradient() + gradient).norm(), 1e-3);
  // On a plane the ground 5 m away is known within the mounting of the scanner: 0.5 degrees.
  EXPECT_NEAR(std::sqrt(ground.below(0.5, {}).variance_m2(5.0f)), 0.044, 0.02);
}

// Ground whose slopes of a metre each are independent: heights stray from the plane as it says.
TEST(GroundPlane, KnowsHowFarBumpsStray) {
  GroundPlane ground(20.0);
  std::mt19937 random(7);
  std::normal_distribution<double> slope(0.0, 0.05);
  for (int body = 0; body < 200; ++body) {
    const double rise = slope(random), side = slope(random);
    for (int i = 0; i < 20; ++i) ground.add({std::atan(side), -std::atan(rise), 0.0}, 0.05, 0.0);
  }
  const double walked_m2 = 0.05 * 0.05 * (1.0 + 4.0), mounted_m2 = std::pow(0.0087 * 4.0, 2);
  EXPECT_NEAR(ground.below(0.5, {}).variance_m2(4.0f), walked_m2 + mounted_m2, 0.4 * walked_m2);
}

}  // namespace
}  // namespace orchard::pose
