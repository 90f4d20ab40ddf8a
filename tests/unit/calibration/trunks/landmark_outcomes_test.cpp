// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/landmark_outcomes.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/angles.hpp"

namespace orchard::calibration {
namespace {

using detection::Detection;
using detection::Detections;
using detection::Label;
using mapping::Candidate;
using mapping::Landmark;

Landmark landmark(Label label, double x_m, double y_m, double width_m) {
  Landmark l;
  l.label = label;
  l.x_m = x_m;
  l.y_m = y_m;
  l.width_m = width_m;
  l.num_observations = 25;
  l.se_x_m = l.se_y_m = 0.002;  // observations scatter by 10 mm
  return l;
}

std::vector<LandmarkMatch> match(const std::vector<Landmark>& landmarks,
                                 const std::vector<Eigen::Vector2d>& places_map,
                                 double sd_m = 0.01) {
  std::vector<Candidate> scan;
  for (const Eigen::Vector2d& p_map : places_map) {
    Candidate candidate;
    candidate.p_map = candidate.p_aligned = p_map;
    candidate.covariance = candidate.aligned_covariance = sd_m * sd_m * Eigen::Matrix2d::Identity();
    scan.push_back(candidate);
  }
  return LandmarkOutcomes(landmarks, {}).match(scan);
}

TEST(LandmarkOutcomes, TheGateEndsWhereItsKeySays) {
  const double gate_m = mapping::MapperConfig().gate_m;
  const std::vector<Landmark> map{landmark(Label::kTree, 5.0, -3.0, 0.1)};
  EXPECT_EQ(match(map, {{5.0 + gate_m - 1e-6, -3.0}})[0].landmark, 0);
  EXPECT_EQ(match(map, {{5.0 + gate_m + 1e-6, -3.0}})[0].landmark, -1);
  EXPECT_EQ(match(map, {{5.0, -3.0 - gate_m - 1e-6}})[0].landmark, -1);
  EXPECT_TRUE(match({}, {}).empty());
  EXPECT_EQ(match({}, {{0.0, 0.0}})[0].landmark, -1);
}

TEST(LandmarkOutcomes, AWideObjectReachesToItsBorderAndAHedgeAlongItsLength) {
  const std::vector<Landmark> bush{landmark(Label::kObject, 0.0, 0.0, 1.6)};
  EXPECT_EQ(match(bush, {{0.79, 0.0}})[0].landmark, 0);
  EXPECT_EQ(match(bush, {{0.81, 0.0}})[0].landmark, -1);
  // The mapper reports nothing wider than 2 m whole: such a width is a mistake.
  EXPECT_EQ(match({landmark(Label::kObject, 0.0, 0.0, 50.0)}, {{1.01, 0.0}})[0].landmark, -1);
  Landmark hedge = landmark(Label::kObject, 0.0, 0.0, 0.8);
  hedge.length_m = 10.0;
  hedge.direction_rad = 0.5 * geometry::kPi;
  EXPECT_EQ(match({hedge}, {{0.35, 4.5}})[0].landmark, 0);
  EXPECT_EQ(match({hedge}, {{4.5, 0.35}})[0].landmark, -1);
  EXPECT_EQ(match({hedge}, {{0.0, 5.1}})[0].landmark, -1);
}

TEST(LandmarkOutcomes, OnlyWhatFitsATreeAndAnObjectIsDoubtful) {
  const std::vector<Landmark> map{landmark(Label::kTree, 0.0, 0.0, 0.1),
                                  landmark(Label::kObject, 0.25, 0.0, 0.1)};
  const LandmarkMatch sure = match(map, {{0.02, 0.0}})[0];
  EXPECT_EQ(sure.landmark, 0);
  EXPECT_FALSE(sure.is_doubtful) << "5 sd from the border of the object";
  EXPECT_TRUE(match(map, {{0.02, 0.0}}, 0.1)[0].is_doubtful) << "2 sd of a worse detection";
  EXPECT_FALSE(match(map, {{0.24, 0.0}})[0].is_doubtful);
  EXPECT_TRUE(match(map, {{0.12, 0.15}})[0].is_doubtful) << "in the gates of both, at neither";
  const std::vector<Landmark> two_trees{map[0], landmark(Label::kTree, 0.25, 0.0, 0.1)};
  EXPECT_FALSE(match(two_trees, {{0.12, 0.15}})[0].is_doubtful);
  EXPECT_EQ(match(two_trees, {{0.13, 0.15}})[0].landmark, 1) << "the nearer";
  EXPECT_TRUE(match({landmark(Label::kUnseen, 0.0, 0.0, 0.1)}, {{0.0, 0.0}})[0].is_doubtful);
}

TEST(LandmarkOutcomes, ATreeIsObservedOnceAScanAndABushInParts) {
  const std::vector<Eigen::Vector2d> parts{{0.2, 0.0}, {0.01, 0.0}, {0.0, -0.25}};
  const auto of_tree = match({landmark(Label::kTree, 0.0, 0.0, 0.1)}, parts);
  EXPECT_EQ(of_tree[0].landmark, -1);
  EXPECT_EQ(of_tree[1].landmark, 0);
  EXPECT_EQ(of_tree[2].landmark, -1);
  for (const LandmarkMatch& found : match({landmark(Label::kObject, 0.0, 0.0, 0.6)}, parts)) {
    EXPECT_EQ(found.landmark, 0);
  }
}

/// A robot that turns by 1 rad/s while its beams sweep for 80 ms: the pose at a time, in closed
/// form.
pose::PoseEstimate pose_at(std::int64_t utime) {
  const double t_s = 1e-6 * static_cast<double>(utime);
  pose::PoseEstimate pose;
  pose.utime = utime;
  pose.x_m = 100.0 + 1.2 * t_s;
  pose.y_m = -50.0;
  pose.yaw_rad = 1.0 * t_s;
  return pose;
}

/// What it observes of a map point at a time: the inverse of its pose.
Detection observed(const Eigen::Vector2d& p_map, std::int64_t utime) {
  const pose::PoseEstimate pose = pose_at(utime);
  const Eigen::Vector2d arm = p_map - Eigen::Vector2d(pose.x_m, pose.y_m);
  const double c = std::cos(pose.yaw_rad), s = std::sin(pose.yaw_rad);
  Detection d;
  d.utime = utime;
  d.centre_x_m = c * arm.x() + s * arm.y();
  d.centre_y_m = -s * arm.x() + c * arm.y();
  d.covariance = {1e-4, 0.0, 1e-4};
  d.width_m = 0.1;
  return d;
}

TEST(LandmarkSamples, AMovingRobotsDetectionsGetTheOutcomeOfWhatStandsThere) {
  // 8 m away, 0.08 rad of a sweep are 0.64 m: without the pose of its own beam, nothing fits.
  const Eigen::Vector2d tree(108.0, -49.0), crate(104.0, -57.0), shadow(98.0, -46.0);
  const LandmarkOutcomes outcomes(
      {landmark(Label::kTree, tree.x(), tree.y(), 0.1),
       landmark(Label::kObject, crate.x(), crate.y(), 0.5), landmark(Label::kTree, 0.0, 0.0, 0.1)},
      {});
  std::vector<pose::PoseEstimate> path;
  for (std::int64_t utime = 0; utime <= 2'000'000; utime += 20'000) path.push_back(pose_at(utime));
  std::vector<Detections> messages;
  for (std::int64_t utime = 100'000; utime < 1'900'000; utime += 100'000) {
    Detections message;
    message.utime = utime;
    message.trunks = {observed(crate, utime + 10'000), observed(tree, utime + 50'000),
                      observed(shadow, utime + 80'000)};
    messages.push_back(message);
  }
  messages.push_back({60'000'000, 0, 0, {observed(tree, 60'000'000)}});  // after the last pose
  const LandmarkSamples found = landmark_samples(messages, path, outcomes, {}, 7);
  EXPECT_EQ(found.num_scans, 19);
  EXPECT_EQ(found.num_placed_scans, 18);
  EXPECT_EQ(found.num_trees, 1);
  EXPECT_EQ(found.num_objects, 1);
  EXPECT_EQ(found.num_matched, 36);
  EXPECT_EQ(found.num_doubtful, 0);
  ASSERT_EQ(found.samples.size(), 54u);
  for (std::size_t i = 0; i < found.samples.size(); ++i) {
    const ProbabilitySample& sample = found.samples[i];
    const Outcome truths[] = {Outcome::kObject, Outcome::kTree, Outcome::kNeither};
    const int objects[] = {1, 0, -1};
    EXPECT_EQ(sample.outcome, truths[i % 3]) << i;
    EXPECT_EQ(sample.object, objects[i % 3]) << i;
    EXPECT_EQ(sample.recording, 7);
    EXPECT_EQ(sample.detection.centre_x_m, messages[i / 3].trunks[i % 3].centre_x_m)
        << "learnt is what the detector sends";
  }
}

}  // namespace
}  // namespace orchard::calibration
