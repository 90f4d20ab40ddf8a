// SPDX-License-Identifier: BSD-3-Clause

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "unit/simulation/rig.hpp"
#include "worlds/angular_interval.hpp"
#include "worlds/observation_truth.hpp"

namespace orchard::simulation {
namespace {

/// A trunk of a scene with its truth.
void add_trunk(Scene& scene, double x_m, double y_m, double radius_m) {
  Cylinder trunk;
  trunk.x_m = x_m;
  trunk.y_m = y_m;
  trunk.radius_m = radius_m;
  trunk.height_m = 2.0;
  scene.add(trunk, detection::Label::kTree, "");
}

World one_cylinder(double x_m, double y_m, double radius_m) {
  Scene scene;
  add_trunk(scene, x_m, y_m, radius_m);
  return scene.world;
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
  const double distance_m = range_m + 0.5 * diameter_m;
  const World world = one_cylinder(distance_m * std::cos(bearing_rad),
                                   distance_m * std::sin(bearing_rad), 0.5 * diameter_m);
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

struct Nearest {
  double range_m = 1e9;
  int target = -1;
};

/// Walks along a ray in small steps until it is inside something: slow, and nothing like the
/// closed forms under test. Good to the step.
Nearest march(const World& world, double x_m, double y_m, double direction_rad, double height_m,
              double range_max_m, int only_target = -1) {
  constexpr double kStep_m = 0.002;
  const double dx = std::cos(direction_rad), dy = std::sin(direction_rad);
  std::vector<Cylinder> cylinders;
  std::vector<Box> boxes;
  for (const Cylinder& c : world.cylinders) {
    const double ex = c.x_m - x_m, ey = c.y_m - y_m;
    if (only_target >= 0 && c.target != only_target) continue;
    if (height_m < c.base_m || height_m > c.base_m + c.height_m) continue;
    if (std::abs(ex * dy - ey * dx) <= c.radius_m && ex * dx + ey * dy > 0) cylinders.push_back(c);
  }
  for (const Box& b : world.boxes) {
    if (only_target >= 0 && b.target != only_target) continue;
    if (height_m >= b.base_m && height_m <= b.base_m + b.height_m) boxes.push_back(b);
  }
  if (cylinders.empty() && boxes.empty()) return {};
  for (double t_m = 0.0; t_m <= range_max_m; t_m += kStep_m) {
    const double px = x_m + t_m * dx, py = y_m + t_m * dy;
    for (const Cylinder& c : cylinders) {
      if (std::hypot(px - c.x_m, py - c.y_m) <= c.radius_m) return {t_m, c.target};
    }
    for (const Box& b : boxes) {
      const double ex = px - b.x_m, ey = py - b.y_m;
      const double along_m = std::cos(b.yaw_rad) * ex + std::sin(b.yaw_rad) * ey;
      const double across_m = -std::sin(b.yaw_rad) * ex + std::cos(b.yaw_rad) * ey;
      if (std::abs(along_m) <= b.length_m / 2 && std::abs(across_m) <= b.width_m / 2) {
        return {t_m, b.target};
      }
    }
  }
  return {};
}

/// Things of every kind that do not touch: trunks, crates, one bush of many twigs.
Scene random_world(std::uint64_t seed) {
  Random random(seed);
  Scene made;
  const auto place = [&](double reach_m, double& x_m, double& y_m) {
    for (;;) {
      const double bearing_rad = random.uniform(-3.1, 3.1), range_m = random.uniform(0.8, 4.6);
      x_m = range_m * std::cos(bearing_rad);
      y_m = range_m * std::sin(bearing_rad);
      if (std::none_of(made.truth.begin(), made.truth.end(), [&](const TruthObject& t) {
            return std::hypot(t.x_m - x_m, t.y_m - y_m) < reach_m + 0.75 * t.width_m;
          })) {
        return;
      }
    }
  };
  for (int i = 0; i < 14; ++i) {
    const double radius_m = random.uniform(0.03, 0.15);
    double x_m = 0.0, y_m = 0.0;
    place(radius_m, x_m, y_m);
    add_trunk(made, x_m, y_m, radius_m);
  }
  for (int i = 0; i < 4; ++i) {
    Box crate;
    crate.length_m = random.uniform(0.3, 0.8);
    crate.width_m = random.uniform(0.1, 0.3);
    crate.yaw_rad = random.uniform(-3.0, 3.0);
    place(crate.length_m, crate.x_m, crate.y_m);
    crate.height_m = 1.0;
    crate.target = static_cast<int>(made.truth.size());
    made.truth.push_back({detection::Label::kObject, crate.x_m, crate.y_m, crate.length_m, ""});
    made.world.boxes.push_back(crate);
  }
  TruthObject bush{detection::Label::kObject, 0.0, 0.0, 0.6, ""};
  place(0.5, bush.x_m, bush.y_m);
  for (int i = 0; i < 15; ++i) {
    Cylinder twig;
    twig.radius_m = 0.02;
    twig.x_m = bush.x_m + random.uniform(-0.2, 0.2);
    twig.y_m = bush.y_m + random.uniform(-0.2, 0.2);
    twig.height_m = 1.0;
    twig.target = static_cast<int>(made.truth.size());
    made.world.cylinders.push_back(twig);
  }
  made.truth.push_back(bush);
  Cylinder low;  // below the scan plane: hides nothing
  low.x_m = 0.4;
  low.radius_m = 0.2;
  low.height_m = 0.1;
  low.target = -1;
  made.world.cylinders.push_back(low);
  return made;
}

TEST(ObservationTruth, IsWhatMarchingAlongTheRaysFinds) {
  const RigConfig rig = test_rig();
  ScannerConfig scanner = rig.simulation.scanner;
  int num_half_hidden = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scene made = random_world(seed);
    const Pose2 pose{0.05, -0.1, 0.3 * static_cast<double>(seed)};
    std::map<int, int> num_beams;
    for (int i = 0; i < scanner.num_beams; ++i) {
      const double direction_rad =
          pose.yaw_rad + scanner.bearing_min_rad + i * scanner.bearing_step_rad;
      const Nearest hit = march(made.world, pose.x_m, pose.y_m, direction_rad, scanner.height_m,
                                scanner.range_max_m);
      ++num_beams[hit.target];
    }
    for (const TrueObservation& seen :
         observe_truth(made.world, made.truth, {pose}, scanner, rig.camera)) {
      // grazing beams may fall on either side of the march's step
      EXPECT_NEAR(seen.num_beams, num_beams[seen.object], seen.object < 18 ? 1 : 3)
          << "seed " << seed << " object " << seen.object;
      // the fraction of fine rays on the thing alone that meet something else before
      const double distance_m = seen.range_m + 0.5 * seen.width_m;
      const double reach_rad =
          std::min(1.2, 0.8 * seen.width_m / (distance_m - 0.4 * seen.width_m));
      int num_own = 0, num_visible = 0;
      constexpr int kRays = 500;
      for (int i = 0; i < kRays; ++i) {
        const double off_rad = reach_rad * (2.0 * (i + 0.5) / kRays - 1.0);
        const double bearing_rad = seen.bearing_rad + off_rad;
        if (std::abs(bearing_rad) > -scanner.bearing_min_rad) continue;  // outside the view
        const double direction_rad = pose.yaw_rad + bearing_rad;
        const Nearest own = march(made.world, pose.x_m, pose.y_m, direction_rad, scanner.height_m,
                                  6.0, seen.object);
        if (own.target < 0) continue;
        ++num_own;
        const Nearest any =
            march(made.world, pose.x_m, pose.y_m, direction_rad, scanner.height_m, 6.0);
        if (any.target == seen.object) ++num_visible;
      }
      ASSERT_GT(num_own, 0);
      const double hidden = 1.0 - static_cast<double>(num_visible) / num_own;
      EXPECT_NEAR(seen.hidden_fraction, hidden, 6.0 / num_own + 0.01)
          << "seed " << seed << " object " << seen.object;
      if (hidden > 0.1 && hidden < 0.9) ++num_half_hidden;
      num_beams.erase(seen.object);
    }
    num_beams.erase(-1);
    for (const auto& [target, n] : num_beams) EXPECT_LE(n, 1) << "unlisted target " << target;
  }
  EXPECT_GT(num_half_hidden, 5);  // the worlds are crowded enough to mean something
}

TEST(ObservationTruth, AMovingScannerIsWhereItsBeamPassesOver) {
  const RigConfig rig = test_rig();
  const ScannerConfig& scanner = rig.simulation.scanner;
  Scene scene;
  for (const double y_m : {-3.0, 3.0}) add_trunk(scene, 2.0, y_m, 0.1);
  std::vector<Pose2> poses;
  for (int i = 0; i < scanner.num_beams; ++i) poses.push_back({0.0003 * i, 0.0, 0.0});
  const auto seen = observe_truth(scene.world, scene.truth, poses, scanner, rig.camera);
  ASSERT_EQ(seen.size(), 2u);
  for (const TrueObservation& o : seen) {
    const double beam = (o.bearing_rad - scanner.bearing_min_rad) / scanner.bearing_step_rad;
    const double x_m = 0.0003 * std::round(beam);
    EXPECT_NEAR(o.range_m, std::hypot(2.0 - x_m, 3.0) - 0.1, 1e-3);
    EXPECT_NEAR(o.bearing_rad, std::atan2(o.y_m, 2.0 - x_m), 1e-3);
  }
  EXPECT_GT(std::abs(seen[0].range_m - seen[1].range_m), 0.03);  // 5 cm farther along by then
  EXPECT_THROW(observe_truth(scene.world, scene.truth, std::vector<Pose2>(3), scanner, rig.camera),
               std::invalid_argument);
}

TEST(ObservationTruth, PictureHoldsWhatItsWholeWidthProjectsInto) {
  RigConfig rig = test_rig();
  rig.camera.intrinsics.kc = {};
  rig.camera.intrinsics.fc_px = {200.0, 200.0};
  rig.camera.intrinsics.cc_px = {159.5, 119.5};
  rig.camera.extrinsics.phi_rad = {geometry::kPi / 2.0, 0.0, geometry::kPi / 2.0};
  rig.camera.extrinsics.delta_m = {0.0, 0.0, 0.0};
  Scene scene;
  // the picture ends 159.5 (160.5 with its last half pixel) pixels from its middle: 38.6 degrees;
  // a trunk takes 1.15 degrees to each side
  for (const double bearing_deg : {0.0, 35.0, 38.0, 41.0, 45.0, -35.0, -41.0}) {
    const double bearing_rad = bearing_deg * geometry::kPi / 180.0;
    add_trunk(scene, 3.0 * std::cos(bearing_rad), 3.0 * std::sin(bearing_rad), 0.06);
  }
  const auto seen =
      observe_truth(scene.world, scene.truth, {Pose2{}}, rig.simulation.scanner, rig.camera);
  ASSERT_EQ(seen.size(), scene.truth.size());
  const std::array<bool, 7> expected{true, true, false, false, false, true, false};
  for (std::size_t i = 0; i < seen.size(); ++i) EXPECT_EQ(seen[i].in_picture, expected[i]) << i;
  rig.camera.enabled = false;
  for (const auto& o :
       observe_truth(scene.world, scene.truth, {Pose2{}}, rig.simulation.scanner, rig.camera)) {
    EXPECT_FALSE(o.in_picture);
  }
}

TEST(AngularInterval, UnitesAndCutsOut) {
  const auto together = united({{2.0, 3.0}, {0.0, 1.0}, {0.5, 1.5}, {2.5, 2.6}, {4.0, 3.9}});
  ASSERT_EQ(together.size(), 2u);
  EXPECT_DOUBLE_EQ(together[0].high_rad, 1.5);
  EXPECT_DOUBLE_EQ(total_width_rad(together), 2.5);
  const auto rest = without({0.0, 10.0}, {{-1.0, 1.0}, {4.0, 5.0}, {4.5, 6.0}, {9.5, 12.0}});
  ASSERT_EQ(rest.size(), 2u);
  EXPECT_DOUBLE_EQ(rest[0].low_rad, 1.0);
  EXPECT_DOUBLE_EQ(rest[0].high_rad, 4.0);
  EXPECT_DOUBLE_EQ(rest[1].low_rad, 6.0);
  EXPECT_DOUBLE_EQ(rest[1].high_rad, 9.5);
  EXPECT_TRUE(without({0.0, 1.0}, {{-1.0, 2.0}}).empty());
}

}  // namespace

}  // namespace orchard::simulation
