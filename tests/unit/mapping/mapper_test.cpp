// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/mapper.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

#include "geometry/angles.hpp"
#include "mapping/map_state.hpp"
#include "mapping/pose_track.hpp"

namespace orchard::mapping {
namespace {

using detection::Detection;
using detection::Detections;
using detection::Label;

Detection seen_at(double x_base_m, double y_base_m, Label label = Label::kTree,
                  double width_m = 0.09) {
  Detection d;
  d.centre_x_m = x_base_m;
  d.centre_y_m = y_base_m;
  d.covariance = {4e-4, 0.0, 4e-4};
  d.width_m = width_m;
  d.width_sd_m = 0.01;
  d.label = label;
  d.roc_tree = label == Label::kTree ? 0.9f : 0.01f;
  return d;
}

Detections scan_of(std::vector<Detection> trunks, std::int64_t utime = 0) {
  Detections detections;
  detections.utime = utime;
  detections.trunks = std::move(trunks);
  return detections;
}

TEST(Mapper, ComposesAsEquations11And12) {
  // the paper's robot looks along Y, and its bearing turns from Y towards X
  const double x_robot = 1.5, y_robot = -0.4, r = 2.0, bearing_rad = 0.3;
  const double beta = geometry::paper_bearing_rad(bearing_rad);
  pose::PoseEstimate pose;
  pose.x_m = x_robot;
  pose.y_m = y_robot;
  pose.yaw_rad = 0.5 * geometry::kPi;
  Mapper mapper({});
  mapper.update(scan_of({seen_at(r * std::cos(bearing_rad), r * std::sin(bearing_rad))}), pose);
  const Landmark l = mapper.landmark(1);
  EXPECT_NEAR(l.x_m, x_robot + r * std::sin(beta), 1e-6);
  EXPECT_NEAR(l.y_m, y_robot + r * std::cos(beta), 1e-6);
}

TEST(Mapper, ABushIsOneObjectWithItsExtent) {
  // leaves anywhere in a disc of radius 0.4 m, three of them in each scan; a trunk 0.6 m beside it
  std::mt19937_64 random(3);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Mapper mapper({});
  for (int scan = 0; scan < 60; ++scan) {
    std::vector<Detection> seen{seen_at(3.0, 1.6, Label::kTree)};
    while (seen.size() < 4) {
      const Eigen::Vector2d p(uniform(-0.4, 0.4), uniform(-0.4, 0.4));
      if (p.norm() > 0.4) continue;
      seen.push_back(seen_at(3.0 + p.x(), 1.0 + p.y(), Label::kObject, uniform(0.02, 0.2)));
    }
    mapper.update(scan_of(std::move(seen), 100000 * scan), {});
  }
  const std::vector<Landmark> all = mapper.landmarks();
  ASSERT_EQ(all.size(), 2u);
  const Landmark& tree = all[0].label == Label::kTree ? all[0] : all[1];
  const Landmark& bush = all[0].label == Label::kTree ? all[1] : all[0];
  EXPECT_EQ(tree.label, Label::kTree);
  EXPECT_NEAR(tree.y_m, 1.6, 0.01);
  EXPECT_NEAR(tree.width_m, 0.09, 0.01);
  EXPECT_EQ(bush.label, Label::kObject);
  EXPECT_NEAR(bush.x_m, 3.0, 0.1);
  EXPECT_NEAR(bush.y_m, 1.0, 0.1);
  EXPECT_NEAR(bush.width_m, 0.8, 0.2);
}

TEST(Mapper, AReflectorKeepsAPoleApartFromTheBoardItStandsAt) {
  // in every fifth scan the reflector shows nothing, and pole and board are one object
  MapperConfig config;
  config.reflector_marks_tree = true;
  Mapper mapper(config);
  for (int scan = 0; scan < 100; ++scan) {
    std::vector<Detection> seen{seen_at(3.0, 0.0, Label::kTree, 0.1),
                                seen_at(3.04, -0.08, Label::kObject, 0.11)};
    if (scan % 5 == 4) seen = {seen_at(3.02, -0.05, Label::kObject, 0.2)};
    mapper.update(scan_of(std::move(seen), 100000 * scan), {});
  }
  const std::vector<Landmark> all = mapper.landmarks();
  ASSERT_EQ(all.size(), 2u);
  const Landmark& pole = all[0].label == Label::kTree ? all[0] : all[1];
  EXPECT_EQ(pole.label, Label::kTree);
  EXPECT_NEAR(pole.y_m, 0.0, 0.01);
  EXPECT_NEAR(pole.width_m, 0.1, 0.02);
}

TEST(Mapper, ATreeThatThePictureHardlyShowsIsSeenAsOftenAsTheLaserJudgesIt) {
  // Two views of one tree are in the picture; beside the robot the laser alone tells, surely. Of
  // another it sees the hidden half alone, which tells nothing.
  Mapper mapper({});
  for (int scan = 0; scan < 40; ++scan) {
    std::vector<Detection> seen{seen_at(2.0, 2.0, scan < 2 ? Label::kTree : Label::kUnseen),
                                seen_at(2.0, -2.0, scan < 2 ? Label::kTree : Label::kUnseen)};
    seen[0].probability_tree = 0.8f;
    seen[0].probability_object = 0.1f;
    mapper.update(scan_of(std::move(seen), 100000 * scan), {});
  }
  ASSERT_EQ(mapper.landmarks(2).size(), 2u);
  const std::vector<Landmark> often = mapper.landmarks(10);
  ASSERT_EQ(often.size(), 1u);
  EXPECT_GT(often[0].y_m, 0.0);
}

TEST(Mapper, ATrunkBesideABushStandsAloneThoughNoPictureShowsIt) {
  // Leaves in a disc of radius 0.4 m, some of which look like a trunk to the laser; the trunk that
  // does so in each scan stands 0.1 m beside them.
  std::mt19937_64 random(3);
  const auto uniform = [&](double a, double b) {
    return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
  };
  Mapper mapper({});
  for (int scan = 0; scan < 60; ++scan) {
    std::vector<Detection> seen;
    while (seen.size() < 3) {
      const Eigen::Vector2d p(uniform(-0.4, 0.4), uniform(-0.4, 0.4));
      if (p.norm() > 0.4) continue;
      const bool is_trunklike = scan > 10 && seen.empty() && scan % 4 == 0;
      seen.push_back(seen_at(3.0 + p.x(), 1.0 + p.y(),
                             is_trunklike ? Label::kUnseen : Label::kObject,
                             is_trunklike ? 0.12 : uniform(0.02, 0.2)));
      if (is_trunklike) seen.back().probability_tree = 0.8f;
    }
    if (scan > 10) {
      seen.push_back(seen_at(3.0, 1.48, Label::kUnseen, 0.12));
      seen.back().probability_tree = 0.8f;
    }
    mapper.update(scan_of(std::move(seen), 100000 * scan), {});
  }
  const std::vector<std::int32_t> strays = mapper.spurious_ids(*mapper.ground());
  std::vector<Landmark> standing;
  for (const Landmark& l : mapper.landmarks()) {
    if (!std::count(strays.begin(), strays.end(), l.id)) standing.push_back(l);
  }
  ASSERT_EQ(standing.size(), 2u);
  const Landmark& bush = standing[0].width_m > 0.4 ? standing[0] : standing[1];
  const Landmark& trunk = standing[0].width_m > 0.4 ? standing[1] : standing[0];
  EXPECT_EQ(bush.label, Label::kObject);
  EXPECT_NEAR(trunk.y_m, 1.48, 0.01);
  EXPECT_NEAR(trunk.width_m, 0.12, 0.01);
}

TEST(Mapper, StatisticsAreThePapers) {
  const double offsets[] = {0.011, -0.007, 0.002, 0.016, -0.013};
  Mapper mapper({});
  double mean = 0.0;
  for (const double o : offsets) mean += o / 5.0;
  double square = 0.0;
  for (const double o : offsets) {
    mapper.update(scan_of({seen_at(2.0 + o, 1.0)}), {});
    square += (o - mean) * (o - mean);
  }
  ASSERT_EQ(mapper.num_landmarks(), 1u);
  const Landmark l = mapper.landmark(1);
  EXPECT_EQ(l.num_observations, 5);
  EXPECT_NEAR(l.se_x_m, std::sqrt(square / 4.0) / std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(l.se_y_m, 0.0, 1e-6);
  EXPECT_NEAR(l.x_m, 2.0 + mean, 1e-3);
  EXPECT_NEAR(l.roc_mean, 0.9, 1e-6);
  EXPECT_EQ(l.label, Label::kTree);
  EXPECT_GT(l.probability, 0.99);
}

TEST(Mapper, ScatterIsHowFarATreesObservationsLieFromIt) {
  Mapper mapper({});
  EXPECT_FALSE(mapper.tree_scatter_m());
  for (int k = 0; k < 40; ++k) {  // on a circle about the tree; an object does not count
    const double angle_rad = 0.5 * geometry::kPi * k;
    mapper.update(scan_of({seen_at(2.0 + 0.03 * std::cos(angle_rad), 0.03 * std::sin(angle_rad)),
                           seen_at(4.0 + 0.1 * std::cos(angle_rad), 1.0, Label::kObject)},
                          k),
                  {});
    EXPECT_EQ(mapper.tree_scatter_m().has_value(), k >= 9);
  }
  EXPECT_NEAR(*mapper.tree_scatter_m(), 0.03, 1e-3);
}

TEST(Mapper, TheObservationsOfAPlantScatterAsFarAsThoseOfAllItsParts) {
  Mapper mapper({});
  for (int k = 0; k < 30; ++k) {  // two stems 0.6 m apart, one in view twice as often
    std::vector<Detection> stems{seen_at(2.0, 0.0)};
    if (k % 2 == 0) stems.push_back(seen_at(2.0, 0.6));
    mapper.update(scan_of(stems, k), {});
  }
  ASSERT_EQ(mapper.num_landmarks(), 2u);
  const Landmark stem = mapper.landmark(1);
  const Landmark plant = mapper.common_place(stem, {1, 2});
  EXPECT_NEAR(plant.y_m, 0.0, 5e-3);  // the other stem draws the densest place a little
  EXPECT_LT(stem.se_y_m, 1e-6);
  // A third of the observations lies 0.6 m away.
  EXPECT_NEAR(plant.se_y_m * std::sqrt(plant.num_observations), 0.6 * std::sqrt(1.0 / 3.0), 5e-3);
  EXPECT_NEAR(plant.se_x_m, 0.0, 1e-6);
}

TEST(Mapper, PairsOneToOneWithStableIds) {
  Mapper mapper({});
  for (int k = 0; k < 10; ++k) {
    const double o = 0.01 * (k % 3 - 1);
    mapper.update(scan_of({seen_at(2.0 + o, 0.0), seen_at(2.0 + o, 0.4), seen_at(3.0 + o, 1.0)}),
                  {});
    ASSERT_EQ(mapper.num_landmarks(), 3u);
  }
  EXPECT_NEAR(mapper.landmark(1).y_m, 0.0, 1e-3);
  EXPECT_NEAR(mapper.landmark(2).y_m, 0.4, 1e-3);
  EXPECT_NEAR(mapper.landmark(3).y_m, 1.0, 1e-3);
  EXPECT_THROW(mapper.landmark(4), std::out_of_range);
  EXPECT_THROW(mapper.landmark(0), std::out_of_range);
}

TEST(Mapper, AClassConflictIsOneLandmark) {
  Mapper mapper({});
  for (const Label label : {Label::kTree, Label::kObject, Label::kTree, Label::kTree}) {
    mapper.update(scan_of({seen_at(2.0, 0.0, label)}), {});
  }
  ASSERT_EQ(mapper.num_landmarks(), 1u);
  EXPECT_EQ(mapper.landmark(1).label, Label::kTree);
  EXPECT_NEAR(mapper.landmark(1).roc_mean, (3 * 0.9 + 0.01) / 4, 1e-6);
}

TEST(Mapper, CountsWhatTheCameraSawOnceItSaw) {
  Mapper mapper({});
  mapper.update(scan_of({seen_at(2.0, 0.0, Label::kUnseen)}), {});
  EXPECT_EQ(mapper.landmark(1).label, Label::kUnseen);
  EXPECT_EQ(mapper.landmark(1).num_observations, 1);
  for (int k = 0; k < 3; ++k) mapper.update(scan_of({seen_at(2.0, 0.0)}), {});
  mapper.update(scan_of({seen_at(2.0, 0.0, Label::kUnseen)}), {});
  ASSERT_EQ(mapper.num_landmarks(), 1u);
  EXPECT_EQ(mapper.landmark(1).num_observations, 3);
  EXPECT_NEAR(mapper.landmark(1).roc_mean, 0.9, 1e-6);
}

TEST(Mapper, MergesWhatTurnsOutToBeOne) {
  MapperConfig config;
  config.merge_m = 0.2;
  config.gate_sigma = 2.0;
  config.align_scans = false;
  Mapper mapper(config);
  mapper.update(scan_of({seen_at(2.0, 0.0)}), {});
  mapper.update(scan_of({seen_at(2.25, 0.0)}), {});  // an outlier: a second landmark
  ASSERT_EQ(mapper.num_landmarks(), 2u);
  for (int k = 0; k < 8; ++k) mapper.update(scan_of({seen_at(2.20 - 0.01 * k, 0.0)}), {});
  ASSERT_EQ(mapper.num_landmarks(), 1u);
  EXPECT_EQ(mapper.landmark(1).num_observations, 10);
  EXPECT_THROW(mapper.landmark(2), std::out_of_range);
}

/// Gates that are wider than trees stand apart, as poses that are off by decimetres need them.
MapperConfig wide_gates() {
  MapperConfig config;
  config.gate_m = 0.95;
  config.gate_sigma = 20.0;
  config.merge_m = 0.98;
  return config;
}

TEST(Mapper, StemsOfOneTreeSeenAtOnceStayOneByWideGates) {
  Mapper mapper(wide_gates());
  for (int k = 0; k < 60; ++k) {
    std::vector<Detection> stems{seen_at(3.0, 0.0)};
    if (k > 0) stems.push_back(seen_at(3.0, 0.4));
    mapper.update(scan_of(stems, k), {});
  }
  EXPECT_EQ(mapper.num_landmarks(), 1u);
  EXPECT_EQ(mapper.num_observations(), 119u);  // echoes are kept: better poses may tell them apart
}

TEST(Mapper, AHedgeIsNotTakenApartByWideGates) {
  Mapper mapper(wide_gates());
  for (int k = 0; k < 60; ++k) {
    std::vector<Detection> parts{seen_at(3.0, 0.4)};
    if (k > 0) parts.insert(parts.end(), {seen_at(3.0, 0.0), seen_at(3.0, 0.8)});
    mapper.update(scan_of(parts, k), {});
  }
  EXPECT_EQ(mapper.num_landmarks(), 1u);
}

TEST(Mapper, OneThingThatAPoseOnceMovedIsMergedByWideGates) {
  MapperConfig config = wide_gates();
  config.gate_m = 0.3;
  Mapper mapper(config);
  for (int k = 0; k < 20; ++k) {
    mapper.update(scan_of({seen_at(3.0, k < 10 ? 0.0 : 0.8), seen_at(5.0, 3.0)}, k), {});
  }
  EXPECT_EQ(mapper.num_landmarks(), 2u);
}

TEST(Mapper, AStraySightOfAKnownTreeIsNoSecondTree) {
  Mapper mapper({});
  for (int k = 0; k < 32; ++k) {
    mapper.update(scan_of({seen_at(2.0 + 0.01 * (k % 3 - 1), 0.0)}), {});
  }
  mapper.update(scan_of({seen_at(2.2, 0.0)}), {});  // half hidden, say: six standard deviations off
  ASSERT_EQ(mapper.num_landmarks(), 1u);
  EXPECT_EQ(mapper.landmark(1).num_observations, 33);
  EXPECT_NEAR(mapper.landmark(1).x_m, 2.0, 0.02);
  mapper.update(scan_of({seen_at(2.2, 0.0, Label::kTree, 0.03)}), {});  // a stake
  EXPECT_EQ(mapper.num_landmarks(), 2u);
  mapper.update(scan_of({seen_at(2.0, 0.0), seen_at(2.0, 0.2)}), {});  // a twin, seen beside it
  EXPECT_EQ(mapper.num_landmarks(), 3u);
}

TEST(Mapper, AnImperfectHeadingDoublesNoTree) {
  // rows 4 m apart with a tree every 3 m; heading off by 0.05 rad (1 sigma)
  std::mt19937_64 bits(7);
  const auto normal = [&] {
    double sum = -6.0;
    for (int k = 0; k < 12; ++k) sum += static_cast<double>(bits() >> 11) * 0x1p-53;
    return sum;
  };
  MapperConfig config;
  config.gate_m = 0.8;
  config.merge_m = 0.5;
  config.align_kernel_m = 0.35;
  Mapper mapper(config);
  for (int k = 0; k < 80; ++k) {
    const double x_robot = 0.25 * k;
    const double yaw_error_rad = 0.05 * normal();
    std::vector<Detection> trunks;
    for (int tree = -1; tree < 9; ++tree) {
      for (const double y : {-2.0, 2.0}) {
        const double dx = 3.0 * tree - x_robot;
        if (std::hypot(dx, y) > 8.0) continue;
        const double c = std::cos(yaw_error_rad), s = std::sin(yaw_error_rad);
        trunks.push_back(
            seen_at(c * dx + s * y + 0.02 * normal(), c * y - s * dx + 0.02 * normal()));
      }
    }
    pose::PoseEstimate pose;  // claims heading 0
    pose.x_m = x_robot;
    pose.covariance = {1e-4, 0, 0, 1e-4, 0, 25e-4};
    mapper.update(scan_of(trunks), pose);
  }
  EXPECT_EQ(mapper.landmarks(5).size(), 20u);
  for (const Landmark& l : mapper.landmarks(5)) {
    const double nearest = 3.0 * std::round(l.x_m / 3.0);
    EXPECT_LT(std::hypot(l.x_m - nearest, std::abs(l.y_m) - 2.0), 0.2);
  }
}

constexpr int kNumTrees = 12;
constexpr double kSpacing_m = 3.0;
constexpr double kReach_m = 6.0;

Eigen::Vector2d tree(int k) { return {kSpacing_m * k, 2.0}; }

/// Up the row and back again; true poses.
std::vector<pose::PoseEstimate> there_and_back() {
  std::vector<pose::PoseEstimate> poses;
  for (int i = 0; i <= 140; ++i) {
    pose::PoseEstimate pose;
    pose.utime = 100000 * i;
    pose.x_m = i <= 70 ? 0.5 * i : 0.5 * (140 - i);
    pose.yaw_rad = i <= 70 ? 0.0 : geometry::kPi;
    pose.covariance = {1e-4, 0, 0, 1e-4, 0, 1e-5};
    poses.push_back(pose);
  }
  return poses;
}

/// The same as dead reckoning tells them: ever farther off to the side, 2.8 m at the end.
pose::PoseEstimate drifted(pose::PoseEstimate pose) {
  pose.y_m += 2e-7 * static_cast<double>(pose.utime);
  pose.covariance = {0.05, 0, 0, 0.05, 0, 1e-4};
  return pose;
}

detection::Detections seen_from(const pose::PoseEstimate& pose, std::mt19937_64& random) {
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  const auto noise_m = [&] { return 0.02 * (static_cast<double>(random() % 2001) / 1000.0 - 1.0); };
  detection::Detections detections;
  detections.utime = pose.utime;
  for (int k = 0; k < kNumTrees; ++k) {
    const Eigen::Vector2d d = tree(k) - Eigen::Vector2d(pose.x_m, pose.y_m);
    if (d.norm() > kReach_m) continue;
    detection::Detection trunk;
    trunk.utime = pose.utime;
    trunk.centre_x_m = c * d.x() + s * d.y() + noise_m();
    trunk.centre_y_m = -s * d.x() + c * d.y() + noise_m();
    trunk.covariance = {2e-4, 0, 2e-4};
    trunk.width_m = 0.12;
    trunk.width_sd_m = 0.01;
    trunk.roc_tree = 0.9f;
    trunk.label = detection::Label::kTree;
    detections.trunks.push_back(trunk);
  }
  return detections;
}

struct Drive {
  Mapper mapper{MapperConfig{}};
  PoseTrack track{2.0};
  pose::Trajectory trajectory;
};

Drive drive() {
  Drive d;
  std::mt19937_64 random(5);
  const auto poses = there_and_back();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    d.track.add(drifted(poses[i]));
    d.mapper.update(seen_from(poses[i], random), drifted(poses[i]));
    if (i % 10 == 0) d.trajectory.poses.push_back(poses[i]);
  }
  d.trajectory.utime = poses.back().utime + 1;
  return d;
}

MapUpdate correct(Drive& d) {
  d.track.correct(d.trajectory);
  return d.mapper.rebuild(
      [&](const pose::PoseEstimate& was) { return d.track.at(was.utime).value(); });
}

TEST(Rebuild, ADriftedDriveBecomesOneLandmarkPerTree) {
  Drive d = drive();
  ASSERT_GT(d.mapper.num_landmarks(), static_cast<std::size_t>(kNumTrees));  // doubled by drift
  const std::size_t num_observations = d.mapper.num_observations();
  const MapUpdate update = correct(d);
  EXPECT_EQ(d.mapper.num_landmarks(), static_cast<std::size_t>(kNumTrees));
  EXPECT_EQ(d.mapper.num_observations(), num_observations);
  std::map<int, int> num_at_tree;
  for (const Landmark& l : d.mapper.landmarks()) {
    const int k = static_cast<int>(std::lround(l.x_m / kSpacing_m));
    ++num_at_tree[k];
    EXPECT_LT((Eigen::Vector2d(l.x_m, l.y_m) - tree(k)).norm(), 0.01);
  }
  EXPECT_EQ(num_at_tree.size(), static_cast<std::size_t>(kNumTrees));
  EXPECT_EQ(update.changed_ids.size(), static_cast<std::size_t>(kNumTrees));
  EXPECT_FALSE(update.removed_ids.empty());
}

TEST(Rebuild, ALandmarkHasTheIdOfItsLargestPart) {
  Drive d = drive();
  std::map<std::int32_t, int> num_before;
  for (const Landmark& l : d.mapper.landmarks()) num_before[l.id] = l.num_observations;
  correct(d);
  for (const Landmark& l : d.mapper.landmarks()) {
    ASSERT_TRUE(num_before.count(l.id)) << "id " << l.id << " is new";
    // Passed twice, and drift of 0.2 m/s parted each pass in two at most.
    EXPECT_GE(4 * num_before[l.id], l.num_observations) << "id " << l.id;
  }
}

TEST(Rebuild, WithoutACorrectionNothingChanges) {
  Drive d = drive();
  const std::vector<Landmark> before = d.mapper.landmarks();
  const MapUpdate update = d.mapper.rebuild([](const pose::PoseEstimate& was) { return was; });
  const std::vector<Landmark> after = d.mapper.landmarks();
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].id, before[i].id);
    EXPECT_EQ(after[i].num_observations, before[i].num_observations);
    EXPECT_NEAR(after[i].x_m, before[i].x_m, 1e-5);  // observations are kept as floats
    EXPECT_NEAR(after[i].y_m, before[i].y_m, 1e-5);
    EXPECT_NEAR(after[i].width_m, before[i].width_m, 1e-5);
    EXPECT_EQ(after[i].label, before[i].label);
  }
  EXPECT_TRUE(update.removed_ids.empty());
}

TEST(Rebuild, TheMapGoesOnAfterIt) {
  Drive d = drive();
  correct(d);
  std::mt19937_64 random(6);
  for (pose::PoseEstimate pose : there_and_back()) {
    pose.utime += 20000000;
    d.mapper.update(seen_from(pose, random), pose);
  }
  EXPECT_EQ(d.mapper.num_landmarks(), static_cast<std::size_t>(kNumTrees));
  EXPECT_THROW(d.mapper.landmark(100000), std::out_of_range);
}

using Indices = std::vector<std::int32_t>;

/// Of observations that were of `then_of` and are of `now_of`.
Indices kept(const Indices& then_of, const Indices& now_of, std::int32_t num_now,
             std::int32_t first_unused) {
  const auto thens = [&](std::int32_t now) {
    Indices all;
    for (std::size_t k = 0; k < now_of.size(); ++k) {
      if (now_of[k] == now) all.push_back(then_of[k]);
    }
    return all;
  };
  return keep_indices(thens, num_now, first_unused);
}

TEST(IdKeeping, TheLargestFractionOfObservationsDecides) {
  // new 0 has two observations of then 4 and one of then 2; new 1 has three of then 2
  EXPECT_EQ(kept({4, 4, 2, 2, 2, 2}, {0, 0, 0, 1, 1, 1}, 2, 5), (Indices{4, 2}));
}

TEST(IdKeeping, WhatWasSplitKeepsTheIdOnceAndTheOtherHalfGetsANewOne) {
  EXPECT_EQ(kept({3, 3, 3, 3, 3}, {0, 0, 1, 1, 1}, 2, 7), (Indices{7, 3}));
}

TEST(IdKeeping, WhatWasMergedKeepsTheIdOfTheLargerPart) {
  EXPECT_EQ(kept({0, 1, 1}, {0, 0, 0}, 1, 2), (Indices{1}));
}

TEST(IdKeeping, EqualSharesGoToTheLowerIndices) {
  EXPECT_EQ(kept({0, 1, 0, 1}, {0, 0, 1, 1}, 2, 2), (Indices{0, 1}));
}

TEST(IdKeeping, NoIndexIsGivenTwiceAndNewOnesWereNeverUsed) {
  // observation 2 belonged to none before; new 2 has no observation any more
  EXPECT_EQ(kept({0, 0, -1}, {1, 1, 0}, 3, 9), (Indices{9, 0, -1}));
}

}  // namespace

}  // namespace orchard::mapping
