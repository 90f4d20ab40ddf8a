// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "mapping/existence/ground_occupancy.hpp"
#include "mapping/free_space.hpp"
#include "mapping/mapper.hpp"
#include "unit/mapping/compare/two_drives.hpp"
#include "unit/mapping/existence/beam_world.hpp"

namespace orchard::mapping {
namespace {

using detection::Detection;
using detection::Detections;
using detection::Label;
using Eigen::Vector2d;

/// Two rows along x at y = -2 and y = 2, a tree every 2 m from 0 to 40.
std::vector<Thing> two_rows() {
  std::vector<Thing> things;
  for (int i = 0; i <= 20; ++i) {
    for (const double y : {-2.0, 2.0}) things.push_back({{2.0 * i, y}});
  }
  return things;
}

/// What a laser half a metre ahead of base, of 8 m and three quarters of a turn, makes of the
/// things: those that nothing nearer covers in the middle, with noise; one in twenty is overlooked.
Detections scan(const std::vector<Thing>& things, const pose::PoseEstimate& T_map_base,
                Dice& dice) {
  const double c = std::cos(T_map_base.yaw_rad), s = std::sin(T_map_base.yaw_rad);
  std::vector<Vector2d> p_laser;
  for (const Thing& thing : things) {
    const Vector2d d = thing.p - Vector2d(T_map_base.x_m, T_map_base.y_m);
    p_laser.push_back({c * d.x() + s * d.y() - 0.5, c * d.y() - s * d.x()});
  }
  Detections detections;
  detections.utime = T_map_base.utime;
  for (std::size_t i = 0; i < things.size(); ++i) {
    const Vector2d& p = p_laser[i];
    if (p.norm() > 8.0 || std::abs(std::atan2(p.y(), p.x())) > 2.35) continue;
    bool hidden = false;
    for (std::size_t k = 0; k < things.size(); ++k) {
      const double along_m = p_laser[k].dot(p) / p.norm();
      if (k == i || along_m < 0.0 || p_laser[k].norm() > p.norm()) continue;
      const double across_m = std::abs(p_laser[k].x() * p.y() - p_laser[k].y() * p.x()) / p.norm();
      hidden = hidden || across_m < 0.5 * things[k].width_m;
    }
    if (hidden || dice.uniform(0, 1) < 0.05) continue;
    Detection d;
    d.centre_x_m = p.x() + 0.5 + dice.normal(0.02);
    d.centre_y_m = p.y() + dice.normal(0.02);
    d.covariance = {4e-4, 0.0, 4e-4};
    d.width_m = things[i].width_m + dice.normal(std::min(0.01, 0.1 * things[i].width_m));
    d.width_sd_m = 0.01;
    d.num_beams = static_cast<std::int32_t>(std::ceil(512 / geometry::kPi * d.width_m / p.norm()));
    d.label = things[i].width_m < 0.3 ? Label::kTree : Label::kObject;
    d.roc_tree = d.label == Label::kTree ? 0.9f : 0.0f;
    detections.trunks.push_back(d);
  }
  return detections;
}

enum class Sees { kDetections, kBeams };

laser::LaserConfig laser_ahead() {
  laser::LaserConfig laser;
  laser.mount_x_m = 0.5;
  return laser;
}

/// Drives the aisle from x = -2 to 42 and back `num_passes` times at 1 m/s, ten scans a second,
/// past what stands there at each time [s]. With beams, the mapper is given those of every third
/// scan. `overlooked` is no detection's from the second pass on.
Mapper drive(int num_passes, const std::function<std::vector<Thing>(double time_s)>& things_at,
             Sees sees = Sees::kBeams, const Vector2d& overlooked = {1e3, 1e3}) {
  Mapper mapper(MapperConfig{}, {0.5, 0.0});
  Dice dice(5);
  for (int k = 0; k < 440 * num_passes; ++k) {
    const double time_s = 0.1 * k;
    const bool back = (k / 440) % 2 == 1;
    const double way_m = 0.1 * (k % 440);
    pose::PoseEstimate pose;
    pose.utime = 1000000 + 100000LL * k;
    pose.x_m = back ? 42.0 - way_m : -2.0 + way_m;
    pose.yaw_rad = back ? 3.14159265358979 : 0.0;
    pose.covariance = {1e-4, 0, 0, 1e-4, 0, 1e-5};
    const std::vector<Thing> things = things_at(time_s);
    std::shared_ptr<const FreeSpace> free_space;
    if (sees == Sees::kBeams && k % 3 == 0) {
      laser::Scan beams = beams_of(things, pose, laser_ahead());
      for (float& range_m : beams.ranges_m) {
        if (range_m > 0.0f) range_m += static_cast<float>(dice.normal(0.01));
      }
      free_space = std::make_shared<FreeSpace>(beams, laser_ahead(), laser::BlindSector{});
    }
    std::vector<Thing> detected = things;
    if (k >= 440) {
      detected.erase(std::remove_if(detected.begin(), detected.end(),
                                    [&](const Thing& t) { return t.p == overlooked; }),
                     detected.end());
    }
    mapper.update(scan(detected, pose, dice), pose, free_space);
  }
  return mapper;
}

/// Landmarks within a box.
int num_within(const Mapper& mapper, const Vector2d& least, const Vector2d& most,
               int min_observations = 1) {
  int num = 0;
  for (const Landmark& l : mapper.landmarks(min_observations)) {
    num += l.x_m > least.x() && l.x_m < most.x() && l.y_m > least.y() && l.y_m < most.y();
  }
  return num;
}

std::vector<Thing> walker_and_rows(double time_s) {
  // two legs on the robot's right, ahead of it, then overtaken
  std::vector<Thing> things = two_rows();
  const double x_m = 4.0 + 0.7 * time_s;
  things.push_back({{x_m, -0.9}, 0.13});
  things.push_back({{x_m + 0.25, -1.08}, 0.13});
  return things;
}

TEST(Existence, WhatMostScansOfTheDriveSeeThroughIsStray) {
  // twigs that sway into single scans, thin, and as thin stems that stand there
  const auto things = [](double time_s) {
    std::vector<Thing> all = two_rows();
    for (int i = 0; i < 10; ++i) {
      all.push_back({{3.0 + 4.0 * i, -1.4}, 0.03});
      const double passing_s = 3.0 + 4.0 * i + 2.0;
      if (std::abs(time_s - passing_s) < 0.12) all.push_back({{3.0 + 4.0 * i, 1.2}, 0.03});
    }
    return all;
  };
  const Mapper mapper = drive(1, things);
  const std::vector<std::int32_t> strays = mapper.spurious_ids(*mapper.ground());
  int num_twigs = 0;
  for (const Landmark& l : mapper.landmarks()) {
    const bool is_stray = std::binary_search(strays.begin(), strays.end(), l.id);
    const bool is_twig = l.y_m > 0.8 && l.y_m < 1.6;
    num_twigs += is_twig && !is_stray;
    if (!is_twig) {
      EXPECT_FALSE(is_stray) << l.x_m << ", " << l.y_m << " n " << l.num_observations;
    }
  }
  EXPECT_EQ(num_twigs, 0);
}

TEST(Existence, ADarkPostThatOnlyNearScansMeetIsNoStray) {
  // Dark bark returns no beam from beyond 1.3 m: all scans from farther away pass through the
  // posts.
  const auto things = [](double time_s) {
    std::vector<Thing> all = two_rows();
    const double laser_x_m = time_s - 1.5;
    for (int i = 0; i < 10; ++i) {
      const Vector2d p(3.0 + 4.0 * i, 0.9);
      if ((p - Vector2d(laser_x_m, 0.0)).norm() < 1.3) all.push_back({p, 0.03});
    }
    return all;
  };
  const Mapper mapper = drive(1, things);
  const std::vector<std::int32_t> strays = mapper.spurious_ids(*mapper.ground());
  int num_stems = 0;
  for (const Landmark& l : mapper.landmarks(4)) {
    if (l.y_m < 0.6 || l.y_m > 1.2) continue;
    num_stems += !std::binary_search(strays.begin(), strays.end(), l.id);
  }
  EXPECT_EQ(num_stems, 10);
}

TEST(Existence, WithoutBeamsNothingIsDropped) {
  const Mapper mapper = drive(2, walker_and_rows, Sees::kDetections);
  EXPECT_GT(num_within(mapper, {-5, -1.6}, {45, 1.6}, 3), 20);
}

TEST(Existence, AVehicleThatDroveAwayIsDropped) {
  const auto things_at = [](double time_s) {
    std::vector<Thing> things = two_rows();
    if (time_s < 44.0) {  // stands there for the whole first pass, wheels and body
      for (const double x_m : {20.5, 21.3, 22.1}) things.push_back({{x_m, 1.2}, 0.5});
      things.push_back({{23.0, 1.0}, 0.13});
    }
    return things;
  };
  EXPECT_EQ(num_within(drive(1, things_at), {20, 0.5}, {24, 1.6}, 10), 4);
  EXPECT_EQ(num_within(drive(2, things_at, Sees::kDetections), {20, 0.5}, {24, 1.6}, 10), 4);
  const Mapper mapper = drive(2, things_at);
  EXPECT_EQ(num_within(mapper, {20, 0.5}, {24, 1.6}), 0);
  EXPECT_EQ(mapper.landmarks(20).size(), 42u);
}

TEST(Existence, BeamsClearAWalkersWayWhileItWalks) {
  // followed for 15 s, which leaves nothing, then overtaken, which the way back clears
  const Mapper once = drive(1, walker_and_rows);
  EXPECT_EQ(num_within(once, {-5, -1.6}, {13, 1.6}), 0);
  EXPECT_GT(num_within(drive(1, walker_and_rows, Sees::kDetections), {-5, -1.6}, {13, 1.6}, 3), 10);
  const Mapper twice = drive(2, walker_and_rows);
  EXPECT_EQ(num_within(twice, {-5, -1.6}, {25, 1.6}, 3), 0);
  EXPECT_EQ(twice.landmarks(20).size(), 42u);
}

TEST(Existence, WhatWalksBesideTheRobotLeavesNothingThoughNoScanObservationsThereAgain) {
  // overtakes the robot slowly, one leg ahead of the other: no later scan looks behind
  const auto things_at = [](double time_s) {
    std::vector<Thing> things = two_rows();
    const double x_m = -3.0 + 1.08 * time_s;
    things.push_back({{x_m, -0.9}, 0.13});
    things.push_back({{x_m + 0.25, -1.08}, 0.13});
    return things;
  };
  EXPECT_GT(num_within(drive(1, things_at, Sees::kDetections), {-5, -1.6}, {45, 1.6}), 20);
  const Mapper mapper = drive(1, things_at);
  // its first seconds, where nothing had looked before; and its last
  EXPECT_EQ(num_within(mapper, {2, -1.6}, {40, 1.6}), 0);
  EXPECT_EQ(mapper.landmarks(20).size(), 42u);
}

TEST(Existence, BeamsClearTheWayOfAVehicleThatDroveAhead) {
  const auto things_at = [](double time_s) {
    std::vector<Thing> things = two_rows();
    if (time_s < 20.0) {  // the robot is 4 m behind it then
      for (const double x_m : {20.5, 21.3, 22.1}) things.push_back({{x_m, 0.8}, 0.5});
      things.push_back({{23.0, 0.6}, 0.13});
    }
    return things;
  };
  const Mapper mapper = drive(1, things_at);
  EXPECT_EQ(num_within(mapper, {20, 0.2}, {24, 1.6}), 0);
  EXPECT_EQ(mapper.landmarks(20).size(), 42u);
}

TEST(Existence, WhatReturnsBeamsStaysThoughNothingDetectsIt) {
  // something about it has changed: every later scan makes no trunk of it
  const auto things_at = [](double) { return two_rows(); };
  const Vector2d tree(20.0, 2.0);
  const auto has_it = [&](const Mapper& mapper) {
    return num_within(mapper, tree - Vector2d(0.3, 0.3), tree + Vector2d(0.3, 0.3)) == 1;
  };
  EXPECT_TRUE(has_it(drive(4, things_at, Sees::kBeams, tree)));
}

TEST(Existence, BeamsOfAFelledTreeDropIt) {
  const auto things_at = [](double time_s) {
    std::vector<Thing> things = two_rows();
    if (time_s > 44.0) things.erase(things.begin() + 20);
    return things;
  };
  EXPECT_EQ(drive(2, things_at).landmarks(20).size(), 41u);
}

TEST(Existence, WhatIsHiddenStays) {
  // Trees 1.5 m behind the left row, in full view at first; then somebody parks crates between
  // the trees of the row, and nothing of those behind is seen any more.
  const auto things_at = [](double time_s) {
    std::vector<Thing> things = two_rows();
    for (int i = 0; i <= 10; ++i) things.push_back({{10.0 + i, 3.5}});
    if (time_s > 44.0) {
      for (int i = 0; i < 22; ++i) things.push_back({{8.0 + 0.8 * i, 2.4}, 0.7});
    }
    return things;
  };
  const Mapper once = drive(1, things_at);
  const Mapper mapper = drive(4, things_at);
  EXPECT_EQ(num_within(once, {9, 3.2}, {21, 3.8}, 10), 11);
  EXPECT_EQ(num_within(mapper, {9, 3.2}, {21, 3.8}, 10), 11);
}

TEST(Existence, AScanFromAWrongPlaceDropsNothing) {
  Mapper mapper = drive(2, [](double) { return two_rows(); });
  ASSERT_EQ(mapper.landmarks(50).size(), 42u);
  Dice dice(6);
  for (int k = 0; k < 600; ++k) {  // the pose says it stands in the aisle; it is carried about
    pose::PoseEstimate pose;
    pose.utime = 200000000 + 100000LL * k;
    pose.x_m = 20.0;
    pose::PoseEstimate truth = pose;
    truth.x_m = 20.0 + 0.9 + 0.01 * k;
    truth.y_m = -8.0;
    truth.yaw_rad = 0.3;
    const auto free_space = std::make_shared<FreeSpace>(beams_of(two_rows(), truth, laser_ahead()),
                                                        laser_ahead(), laser::BlindSector{});
    mapper.update(scan(two_rows(), truth, dice), pose, k % 2 == 0 ? free_space : nullptr);
  }
  EXPECT_EQ(
      num_within(mapper, {-1, -2.2}, {41, -1.8}, 50) + num_within(mapper, {-1, 1.8}, {41, 2.2}, 50),
      42);
}

TEST(Existence, IsTheSameWhenRebuilt) {
  const auto things_at = [](double time_s) {
    std::vector<Thing> things = two_rows();
    if (time_s < 44.0) things.push_back({{21.0, 0.8}});
    return things;
  };
  Mapper mapper = drive(2, things_at);
  const std::vector<Landmark> before = mapper.landmarks();
  mapper.rebuild([](const pose::PoseEstimate& was) { return was; });
  const std::vector<Landmark> after = mapper.landmarks();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].id, before[i].id);
    EXPECT_NEAR(after[i].x_m, before[i].x_m, 1e-3);
  }
}

/// The class of a thing seen by planes of scans so high above ground that strays from its own plane
/// by 0.2 m (one sigma).
Label seen_from(const std::vector<float>& heights_m, Label label) {
  const Thing thing{{3.0, 0.0}, 0.4};
  Mapper mapper({}, {0.5, 0.0});
  for (std::size_t k = 0; k < heights_m.size(); ++k) {
    pose::PoseEstimate pose;
    pose.utime = 1000000 + 100000LL * static_cast<std::int64_t>(k);
    laser::Scan beams = beams_of({thing}, pose, laser_ahead());
    beams.over_ground = {heights_m[k], 0.0f, 0.0f, 0.04f, 0.0f, 0.0f};
    Detection d;
    d.centre_x_m = 3.0;
    d.covariance = {4e-4, 0.0, 4e-4};
    d.width_m = thing.width_m;
    d.width_sd_m = 0.01;
    d.label = label;
    Detections detections{pose.utime, 0, 0, {d}};
    mapper.update(detections, pose,
                  std::make_shared<FreeSpace>(beams, laser_ahead(), laser::BlindSector{}));
  }
  mapper.rebuild([](const pose::PoseEstimate& was) { return was; });
  return mapper.landmarks().at(0).label;
}

// Of ground that strays by 0.2 m one place in 30,000 is higher than 0.8 m.
TEST(Clearance, WhatWasOnlySeenWhereTheGroundMayBeIsNoObject) {
  EXPECT_EQ(seen_from({0.5f, 0.7f, 0.79f}, Label::kObject), Label::kUnseen);
  EXPECT_EQ(seen_from({0.5f, 0.81f, 0.7f}, Label::kObject), Label::kObject);
  EXPECT_EQ(seen_from({0.5f, 0.7f, 0.79f}, Label::kTree), Label::kTree);
  const laser::Scan level = beams_of({{{3.0, 0.0}, 0.4}}, {}, laser_ahead());
  const FreeSpace seen(level, laser_ahead(), laser::BlindSector{});
  EXPECT_EQ(seen.clearance({3.0, 0.0}), Clearance::kUntold);
}

/// What is detected in one scan only: one stands there in all scans, the other in none.
const Thing kBush{{5.0, -1.4}, 1.2}, kView{{5.0, 1.2}, 1.4};

/// A robot passes a row of trees at y = 2, a metre apart, at 1 m/s, ten scans a second.
Mapper drive() {
  std::vector<Thing> trees;
  for (int i = 0; i <= 10; ++i) trees.push_back({{1.0 * i, 2.0}});
  std::vector<Thing> things = trees;
  things.push_back(kBush);
  const laser::LaserConfig laser;
  Mapper mapper(MapperConfig{}, {laser.mount_x_m, laser.mount_y_m});
  for (int k = 0; k < 100; ++k) {
    pose::PoseEstimate pose;
    pose.utime = 1'000'000 + 100'000LL * k;
    pose.x_m = 0.1 * k;
    pose.covariance = {1e-6, 0, 0, 1e-6, 0, 1e-8};
    detection::Detections detections;
    detections.utime = pose.utime;
    const auto add = [&](const Thing& thing) {
      detection::Detection d;
      d.centre_x_m = thing.p.x() - pose.x_m;
      d.centre_y_m = thing.p.y();
      d.covariance = {1e-4, 0.0, 1e-4};
      d.width_m = thing.width_m;
      d.width_sd_m = 0.01;
      d.num_beams = 20;
      d.label = thing.width_m < 0.3 ? detection::Label::kTree : detection::Label::kObject;
      detections.trunks.push_back(d);
    };
    for (const Thing& tree : trees) {
      if ((tree.p - Vector2d(pose.x_m, 0.0)).norm() < 4.0) add(tree);
    }
    if (k == 30) {
      add(kBush);
      add(kView);
    }
    mapper.update(
        detections, pose,
        std::make_shared<FreeSpace>(beams_of(things, pose, laser), laser, laser::BlindSector{}));
  }
  return mapper;
}

TEST(WideStrays, GroundThatScansSawFreeIsThatOfNothing) {
  const Mapper mapper = drive();
  const std::vector<std::int32_t> strays = mapper.spurious_ids(*mapper.ground());
  int num_trees = 0, num_bushes = 0, num_views = 0;
  for (const Landmark& l : mapper.landmarks()) {
    const bool is_stray = std::binary_search(strays.begin(), strays.end(), l.id);
    if (l.width_m < 0.3) {
      ++num_trees;
      EXPECT_FALSE(is_stray) << l.x_m;
    } else if (l.y_m < 0.0) {
      ++num_bushes;
      EXPECT_FALSE(is_stray) << "the bush";
    } else {
      ++num_views;
      EXPECT_TRUE(is_stray) << "the view";
    }
  }
  EXPECT_EQ(num_trees, 11);
  EXPECT_EQ(num_bushes, 1);
  EXPECT_EQ(num_views, 1);
}

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
