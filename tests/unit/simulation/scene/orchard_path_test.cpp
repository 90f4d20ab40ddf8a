// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/orchard_path.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "geometry/angles.hpp"
#include "simulation/scene/orchard_scene.hpp"

namespace orchard::simulation {
namespace {

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

TEST(OrchardPath, GoesRoundSmoothlyThroughEveryAlleyAndClearOfEverything) {
  for (const int num_rows : {4, 5}) {
    const Scene scene = make_orchard_scene(7, block(num_rows, 1));
    constexpr double kStep_s = 0.05;
    const double middle_m = kRowsBegin_m + 5.0;
    std::set<long> alleys;
    Pose2 before = scene.path.pose_at(0.0);
    for (double t_s = kStep_s; t_s < scene.path.duration_s(); t_s += kStep_s) {
      const Pose2 now = scene.path.pose_at(t_s);
      EXPECT_NEAR(std::hypot(now.x_m - before.x_m, now.y_m - before.y_m), kStep_s, 1e-4);
      const double turn_rad = geometry::wrap_angle_rad(now.yaw_rad - before.yaw_rad);
      EXPECT_LE(std::abs(turn_rad), 0.5 * kStep_s + 1e-9);
      if ((before.y_m - middle_m) * (now.y_m - middle_m) < 0.0) {
        EXPECT_NEAR(std::remainder(now.x_m, 4.0), 0.0, 1e-6);
        alleys.insert(std::lround(now.x_m / 4.0));
      }
      for (const TruthObject& thing : scene.truth) {
        EXPECT_GT(std::hypot(thing.x_m - now.x_m, thing.y_m - now.y_m), 0.5 * thing.width_m + 0.5);
      }
      before = now;
    }
    // an odd number of alleys is closed outside of the first row
    const std::set<long> wanted =
        num_rows == 4 ? std::set<long>{-1, 0, 1, 2} : std::set<long>{0, 1, 2, 3};
    EXPECT_EQ(alleys, wanted);
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

TEST(OrchardPath, IsCarriedIntoAnotherAlleyAndDrivesOnThere) {
  const OrchardConfig config = block(6, 1);
  const DrivePath plain = make_orchard_path(1, config, {});
  CarryConfig carry;
  carry.at_s = 8.0;  // in the first alley
  carry.for_s = 6.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    carry.to_alley = seed <= 10 ? 0 : 3;
    const DrivePath path = make_orchard_path(seed, config, carry);
    expect_pose(path.pose_at(8.0), 0.0, 8.0, geometry::kPi / 2.0);
    EXPECT_FALSE(path.carried_at(7.9));
    EXPECT_TRUE(path.carried_at(8.1));
    EXPECT_TRUE(path.carried_at(13.9));
    EXPECT_FALSE(path.carried_at(14.1));
    const Pose2 down = path.pose_at(14.0);
    const long alley = std::lround(down.x_m / 4.0);
    EXPECT_GE(alley, 1);
    if (carry.to_alley == 3) {
      EXPECT_EQ(alley, 2);
    }
    EXPECT_NEAR(down.x_m, 4.0 * alley, 1e-6);
    EXPECT_NEAR(std::sin(down.yaw_rad), alley % 2 == 0 ? 1.0 : -1.0, 1e-6);
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

TEST(OrchardPath, GyroscopeAgreesWithThePath) {
  const DrivePath path = make_orchard_path(1, block(5, 1), {});
  double yaw_rad = path.pose_at(0.0).yaw_rad;
  constexpr double kStep_s = 0.001;
  for (double t_s = 0.0; t_s < path.duration_s(); t_s += kStep_s) {
    yaw_rad += kStep_s * path.yaw_rate_at(t_s + 0.5 * kStep_s);
  }
  EXPECT_NEAR(geometry::wrap_angle_rad(yaw_rad - path.pose_at(path.duration_s()).yaw_rad), 0.0,
              0.01);
}

}  // namespace
}  // namespace orchard::simulation
