// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/existence/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "unit/mapping/existence/beam_world.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

const laser::LaserConfig kLaser = [] {
  laser::LaserConfig laser;
  laser.mount_x_m = 0.5;
  laser.range_sd_m = 0.01;
  laser.range_sd_fraction = 0.0;
  return laser;
}();

BeamLook look_at(const std::vector<Thing>& things) {
  return BeamLook(beams_of(things, {}, kLaser), kLaser, {});
}

/// A wall behind all that is looked at, so that every beam returns.
std::vector<Thing> before_a_wall(std::vector<Thing> things) {
  for (int i = 0; i < 120; ++i) {
    const double bearing_rad = -2.3 + 4.6 * i / 119;
    things.push_back({{0.5 + 7.0 * std::cos(bearing_rad), 7.0 * std::sin(bearing_rad)}, 0.4});
  }
  return things;
}

TEST(BeamLook, TellsWhatStandsFromWhatDoesNot) {
  const BeamLook look = look_at(before_a_wall({{{3.0, 1.0}, 0.12}}));
  EXPECT_EQ(look.at({3.0, 1.0}, 0.12, 0.02).verdict, BeamVerdict::kReturns);
  EXPECT_EQ(look.at({3.0, -1.0}, 0.12, 0.02).verdict, BeamVerdict::kSeesPast);
  EXPECT_EQ(look.at({3.0, 0.5}, 0.12, 0.02).verdict, BeamVerdict::kSeesPast);
  EXPECT_NEAR(look.at({3.0, 0.5}, 0.12, 0.02).num_across, 7.7, 1.0);  // 47 mrad at 2.55 m
  // where it may be reaches to what stands beside it
  EXPECT_EQ(look.at({3.0, 0.5}, 0.12, 0.22).verdict, BeamVerdict::kReturns);
}

TEST(BeamLook, SaysNothingOfWhatIsHiddenOrOutOfSight) {
  const BeamLook look = look_at(before_a_wall({{{2.0, 0.0}, 0.4}}));
  EXPECT_EQ(look.at({4.0, 0.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);   // behind
  EXPECT_EQ(look.at({4.0, 0.46}, 0.12, 0.05).verdict, BeamVerdict::kUnknown);  // half behind
  EXPECT_EQ(look.at({4.0, 1.2}, 0.12, 0.02).verdict, BeamVerdict::kSeesPast);
  EXPECT_EQ(look.at({-4.0, 0.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);  // behind the robot
  EXPECT_EQ(look.at({0.52, 0.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);  // on the laser
  EXPECT_EQ(look.at({8.4, 2.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);   // beyond reach
  // too narrow for two beams of 0.35 degrees
  EXPECT_EQ(look.at({5.5, 2.0}, 0.02, 0.02).verdict, BeamVerdict::kUnknown);
}

TEST(BeamLook, NoReturnCountsNearByOnly) {
  laser::Scan scan = beams_of({}, {}, kLaser);
  scan.range_max_m = 8.0;
  const BeamLook look(scan, kLaser, {});
  EXPECT_EQ(look.at({3.0, 0.0}, 0.12, 0.02).verdict, BeamVerdict::kSeesPast);
  EXPECT_EQ(look.at({6.0, 0.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);
}

TEST(BeamLook, ABeamThatIsNotBelievedSaysNothing) {
  laser::Scan scan = beams_of(before_a_wall({}), {}, kLaser);
  const laser::BlindSector ahead{0.0, 0.3};
  EXPECT_EQ(BeamLook(scan, kLaser, ahead).at({3.0, 0.0}, 0.12, 0.02).verdict,
            BeamVerdict::kUnknown);
  EXPECT_EQ(BeamLook(scan, kLaser, ahead).at({3.0, 2.0}, 0.12, 0.02).verdict,
            BeamVerdict::kSeesPast);
  for (float& range_m : scan.ranges_m) range_m = 0.01f;  // nearer than the scanner believes
  EXPECT_EQ(BeamLook(scan, kLaser, {}).at({3.0, 2.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);
  scan.ranges_m.assign(scan.ranges_m.size(), std::nanf(""));
  EXPECT_EQ(BeamLook(scan, kLaser, {}).at({3.0, 2.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);
  scan.ranges_m.clear();
  EXPECT_EQ(BeamLook(scan, kLaser, {}).at({3.0, 2.0}, 0.12, 0.02).verdict, BeamVerdict::kUnknown);
}

TEST(BeamLook, FollowsTheSweepOfATurningRobot) {
  // turning left at 1 rad/s, a sweep of 75 ms: at its end the tree stands 4 degrees to the right
  laser::LaserConfig laser = kLaser;
  laser.mount_x_m = 0.0;
  laser.mount_yaw_rad = 0.2;
  const std::vector<Thing> things = before_a_wall({{{2.0, 3.0}, 0.12}});
  const Eigen::Vector3d velocity(0.8, 0.0, 1.0);
  const laser::Scan scan = beams_of(things, {}, laser, velocity);
  BeamLook look(scan, laser, {}, {});
  EXPECT_EQ(look.at({2.0, 3.0}, 0.12, 0.01).verdict, BeamVerdict::kSeesPast);
  look.set_velocity(velocity);
  EXPECT_EQ(look.at({2.0, 3.0}, 0.12, 0.01).verdict, BeamVerdict::kReturns);
}

}  // namespace
}  // namespace orchard::mapping
