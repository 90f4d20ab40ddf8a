// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/free_space.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "mapping/existence/ground_occupancy.hpp"
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

FreeSpace free_space_of(const std::vector<Thing>& things) {
  return FreeSpace(beams_of(things, {}, kLaser), kLaser, {});
}

/// A wall behind everything, so that every beam returns.
std::vector<Thing> before_a_wall(std::vector<Thing> things) {
  for (int i = 0; i < 120; ++i) {
    const double bearing_rad = -2.3 + 4.6 * i / 119;
    things.push_back({{0.5 + 7.0 * std::cos(bearing_rad), 7.0 * std::sin(bearing_rad)}, 0.4});
  }
  return things;
}

TEST(FreeSpace, TellsWhatStandsFromWhatDoesNot) {
  const FreeSpace free_space = free_space_of(before_a_wall({{{3.0, 1.0}, 0.12}}));
  EXPECT_EQ(free_space.at({3.0, 1.0}, 0.12, 0.02).evidence, FreeSpaceEvidence::kReturns);
  EXPECT_EQ(free_space.at({3.0, -1.0}, 0.12, 0.02).evidence, FreeSpaceEvidence::kPassesThrough);
  EXPECT_EQ(free_space.at({3.0, 0.5}, 0.12, 0.02).evidence, FreeSpaceEvidence::kPassesThrough);
  EXPECT_NEAR(free_space.at({3.0, 0.5}, 0.12, 0.02).num_across, 7.7, 1.0);  // 47 mrad at 2.55 m
  // where it may be reaches to what stands beside it
  EXPECT_EQ(free_space.at({3.0, 0.5}, 0.12, 0.22).evidence, FreeSpaceEvidence::kReturns);
}

TEST(FreeSpace, SaysNothingOfWhatIsHiddenOrOutOfSight) {
  const FreeSpace free_space = free_space_of(before_a_wall({{{2.0, 0.0}, 0.4}}));
  EXPECT_EQ(free_space.at({4.0, 0.0}, 0.12, 0.02).evidence, FreeSpaceEvidence::kUnknown);  // behind
  EXPECT_EQ(free_space.at({4.0, 0.46}, 0.12, 0.05).evidence,
            FreeSpaceEvidence::kUnknown);  // half behind
  EXPECT_EQ(free_space.at({4.0, 1.2}, 0.12, 0.02).evidence, FreeSpaceEvidence::kPassesThrough);
  EXPECT_EQ(free_space.at({-4.0, 0.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);  // behind the robot
  EXPECT_EQ(free_space.at({0.52, 0.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);  // on the laser
  EXPECT_EQ(free_space.at({8.4, 2.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);  // beyond reach
  // too narrow for two beams of 0.35 degrees
  EXPECT_EQ(free_space.at({5.5, 2.0}, 0.02, 0.02).evidence, FreeSpaceEvidence::kUnknown);
}

TEST(FreeSpace, CountsBeamsThroughAPassageAndBeamsThatEndInIt) {
  // two bushes 0.35 m apart, 2.5 m ahead of the laser: 0.25 m of it are 16 beams of 6.1 mrad
  std::vector<Thing> bushes{{{3.0, -0.5}, 0.6}, {{3.0, 0.45}, 0.6}};
  const Vector2d from(3.0, -0.15), to(3.0, 0.1);
  const PassageBeams open = free_space_of(before_a_wall(bushes)).through(from, to, 0.2, 0.5);
  EXPECT_GE(open.num_through, 12);
  EXPECT_EQ(open.num_within, 0);
  bushes.push_back({{3.0, -0.03}, 0.1});
  const PassageBeams grown = free_space_of(before_a_wall(bushes)).through(from, to, 0.2, 0.5);
  EXPECT_NEAR(grown.num_within, 6, 1);
  EXPECT_LT(grown.num_through, open.num_through - 5);
  // a bunch of leaves close behind it tells nothing either way
  bushes.back().p.x() = 3.5;
  const PassageBeams deep = free_space_of(before_a_wall(bushes)).through(from, to, 0.2, 0.5);
  EXPECT_EQ(deep.num_within, 0);
  EXPECT_LT(deep.num_through, open.num_through - 5);
  // what hides it tells nothing of it, nor does what is seen of it along its line
  bushes.back() = {{1.5, 0.0}, 0.8};
  const PassageBeams hidden = free_space_of(before_a_wall(bushes)).through(from, to, 0.2, 0.5);
  EXPECT_EQ(hidden.num_within + hidden.num_through, 0);
  const PassageBeams in_line = free_space_of({}).through({2.0, 0.01}, {2.5, 0.01}, 0.2, 0.5);
  EXPECT_EQ(in_line.num_within + in_line.num_through, 0);
}

/// A bush and a bin beside the way, 0.22 m apart. The position between them is as wide as the gap,
/// so that what beams hit beside it counts for it; the beams through the gap tell. Without them
/// (none goes on for 20 m) the position decides.
TEST(GroundOccupancy, APassageThatBeamsCrossIsNotShut) {
  for (const bool is_grown : {false, true}) {
    std::vector<Thing> things{{{1.6, 0.0}, 0.6}, {{1.8, 0.9}, 0.8}};
    if (is_grown) things.push_back({{1.68, 0.41}, 0.25});
    std::vector<std::shared_ptr<const FreeSpace>> scans;
    GroundOccupancy ground(
        [&](std::int32_t scan) { return scans[static_cast<std::size_t>(scan)]; });
    for (int k = 0; k < 14; ++k) {
      pose::PoseEstimate pose;
      pose.y_m = -2.0 + 0.3 * k;
      pose.yaw_rad = 0.5 * geometry::kPi;
      scans.push_back(std::make_shared<FreeSpace>(beams_of(things, pose, kLaser), kLaser,
                                                  laser::BlindSector{}));
      ground.add_scan(k, pose);
    }
    EXPECT_EQ(ground.passage({1.67, 0.34}, {1.71, 0.49}, 0.2, 0.5),
              is_grown ? Passage::kShut : Passage::kOpen);
    EXPECT_EQ(ground.passage({1.67, 0.34}, {1.71, 0.49}, 0.2, 20.0), Passage::kShut) << is_grown;
    EXPECT_EQ(ground.passage({30.0, 0.0}, {30.2, 0.0}, 0.2, 0.5), Passage::kUnknown);
  }
}

TEST(FreeSpace, NoReturnCountsNearByOnly) {
  laser::Scan scan = beams_of({}, {}, kLaser);
  scan.range_max_m = 8.0;
  const FreeSpace free_space(scan, kLaser, {});
  EXPECT_EQ(free_space.at({3.0, 0.0}, 0.12, 0.02).evidence, FreeSpaceEvidence::kPassesThrough);
  EXPECT_EQ(free_space.at({6.0, 0.0}, 0.12, 0.02).evidence, FreeSpaceEvidence::kUnknown);
}

TEST(FreeSpace, ABeamThatIsNotBelievedSaysNothing) {
  laser::Scan scan = beams_of(before_a_wall({}), {}, kLaser);
  const laser::BlindSector ahead{0.0, 0.3};
  EXPECT_EQ(FreeSpace(scan, kLaser, ahead).at({3.0, 0.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);
  EXPECT_EQ(FreeSpace(scan, kLaser, ahead).at({3.0, 2.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kPassesThrough);
  for (float& range_m : scan.ranges_m) range_m = 0.01f;  // nearer than the scanner believes
  EXPECT_EQ(FreeSpace(scan, kLaser, {}).at({3.0, 2.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);
  scan.ranges_m.assign(scan.ranges_m.size(), std::nanf(""));
  EXPECT_EQ(FreeSpace(scan, kLaser, {}).at({3.0, 2.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);
  scan.ranges_m.clear();
  EXPECT_EQ(FreeSpace(scan, kLaser, {}).at({3.0, 2.0}, 0.12, 0.02).evidence,
            FreeSpaceEvidence::kUnknown);
}

TEST(FreeSpace, FollowsTheSweepOfATurningRobot) {
  // turning left at 1 rad/s, a sweep of 75 ms: at its end the tree stands 4 degrees to the right
  laser::LaserConfig laser = kLaser;
  laser.mount_x_m = 0.0;
  laser.mount_yaw_rad = 0.2;
  const std::vector<Thing> things = before_a_wall({{{2.0, 3.0}, 0.12}});
  const Eigen::Vector3d velocity(0.8, 0.0, 1.0);
  const laser::Scan scan = beams_of(things, {}, laser, velocity);
  FreeSpace free_space(scan, laser, {});
  EXPECT_EQ(free_space.at({2.0, 3.0}, 0.12, 0.01).evidence, FreeSpaceEvidence::kPassesThrough);
  free_space.set_velocity(velocity);
  EXPECT_EQ(free_space.at({2.0, 3.0}, 0.12, 0.01).evidence, FreeSpaceEvidence::kReturns);
}

}  // namespace
}  // namespace orchard::mapping
