// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory_evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"

namespace orchard::evaluation {
namespace {

constexpr double kPi = geometry::kPi;

Track track(std::vector<TrackPose> poses, bool has_yaw = true) {
  return {std::move(poses), has_yaw};
}

/// Once a second along x at 1 m/s, facing along x.
Track straight(int num_poses) {
  Track result;
  for (int i = 0; i < num_poses; ++i) result.poses.push_back({i * 1000000, 1.0 * i, 0.0, 0.0});
  return result;
}

/// An L of two legs, so that turns and places are told apart.
Track bend() {
  return track({{0, 0, 0, 0},
                {1000000, 2, 0, 0},
                {2000000, 4, 0, kPi / 2},
                {3000000, 4, 3, kPi / 2},
                {4000000, 4, 6, kPi / 2}});
}

Track moved(Track from, double x_m, double y_m, double yaw_rad) {
  for (TrackPose& pose : from.poses) {
    const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    pose = {pose.utime, x_m + c * pose.x_m - s * pose.y_m, y_m + s * pose.x_m + c * pose.y_m,
            geometry::wrap_angle_rad(pose.yaw_rad + yaw_rad)};
  }
  return from;
}

TEST(ErrorStatistics, AreThoseOfNumpy) {
  // by hand: (1 + 4 + 16 + 49) / 4 = 17.5; (6.25 + 2.25 + 0.25 + 12.25) / 4 = 5.25
  const ErrorStatistics e = error_statistics({7.0, 1.0, 4.0, 2.0});
  EXPECT_EQ(e.num, 4);
  EXPECT_DOUBLE_EQ(e.mean, 3.5);
  EXPECT_DOUBLE_EQ(e.median, 3.0);
  EXPECT_DOUBLE_EQ(e.rmse, std::sqrt(17.5));
  EXPECT_DOUBLE_EQ(e.sd, std::sqrt(5.25));
  EXPECT_EQ(e.min, 1.0);
  EXPECT_EQ(e.max, 7.0);
  EXPECT_EQ(error_statistics({5.0, 1.0, 2.0}).median, 2.0);
  EXPECT_EQ(error_statistics({}).num, 0);
}

TEST(EvaluateTrajectory, ComparesWithTheTruthAtThePosesTime) {
  const auto evaluation = evaluate_trajectory(
      track({{500000, 0.5, 0.3, 0.1}, {1000000, 1.0, -0.4, -0.2}}), straight(3), {});
  ASSERT_EQ(evaluation.compared.size(), 2u);
  EXPECT_NEAR(evaluation.compared[0].truth.x_m, 0.5, 1e-12);
  EXPECT_NEAR(evaluation.position_m.max, 0.4, 1e-12);
  EXPECT_NEAR(evaluation.position_m.rmse, std::sqrt((0.09 + 0.16) / 2.0), 1e-12);
  EXPECT_NEAR(evaluation.yaw_rad.rmse, std::sqrt((0.01 + 0.04) / 2.0), 1e-12);
  EXPECT_NEAR(evaluation.compared[1].yaw_error_rad, -0.2, 1e-12);
}

TEST(EvaluateTrajectory, YawGoesTheShorterWay) {
  const double almost_rad = kPi - 0.1;
  const auto evaluation =
      evaluate_trajectory(track({{500000, 0, 0, kPi}}),
                          track({{0, 0, 0, almost_rad}, {1000000, 0, 0, -almost_rad}}), {});
  EXPECT_NEAR(evaluation.yaw_rad.max, 0.0, 1e-12);
}

TEST(EvaluateTrajectory, NeitherExtrapolatesNorCrossesGaps) {
  Track truth = straight(11);
  truth.poses.erase(truth.poses.begin() + 4, truth.poses.begin() + 8);  // 3 s ... 8 s
  const Track estimate = track({{-1, 0, 0, 0},
                                {2500000, 2.5, 0, 0},
                                {3000000, 3, 0, 0},
                                {3000001, 3, 0, 0},
                                {7999999, 8, 0, 0},
                                {8000000, 8, 0, 0},
                                {10000000, 10, 0, 0},
                                {10000001, 10, 0, 0}});
  auto evaluation = evaluate_trajectory(estimate, truth, {});
  EXPECT_EQ(evaluation.num_outside, 2);
  EXPECT_EQ(evaluation.num_in_gaps, 2);
  EXPECT_EQ(evaluation.compared.size(), 4u);
  EXPECT_NEAR(evaluation.gap_max_s, 3.0, 1e-12);
  TrajectoryRules rules;
  rules.gap_max_s = 5.0;  // not longer than 5 s is no gap
  evaluation = evaluate_trajectory(estimate, truth, rules);
  EXPECT_EQ(evaluation.num_in_gaps, 0);
  EXPECT_EQ(evaluation.compared.size(), 6u);
}

TEST(EvaluateTrajectory, AlignmentTakesARigidMotionAwayWhole) {
  const Track estimate = moved(bend(), -7.0, 3.0, 2.5);
  TrajectoryRules rules;
  EXPECT_GT(evaluate_trajectory(estimate, bend(), rules).position_m.rmse, 1.0);
  for (const Alignment alignment : {Alignment::kRigid, Alignment::kOrigin}) {
    rules.alignment = alignment;
    const auto evaluation = evaluate_trajectory(estimate, bend(), rules);
    EXPECT_NEAR(evaluation.position_m.max, 0.0, 1e-9);
    EXPECT_NEAR(evaluation.yaw_rad.max, 0.0, 1e-9);
    EXPECT_NEAR(evaluation.T_truth_estimate.yaw_rad, -2.5, 1e-9);
  }
}

TEST(EvaluateTrajectory, RigidAlignmentIsTheLeastSquaresOne) {
  // a cross of four points, one arm stretched by 1: by hand the rotation stays 0 and the middle
  // of the estimate moves by 1/4, so squares are (3/4)^2 + 3 (1/4)^2 = 3/4
  const Track truth = track({{0, 1, 0, 0}, {1, 0, 1, 0}, {2, -1, 0, 0}, {3, 0, -1, 0}});
  Track estimate = truth;
  estimate.poses[0].x_m = 2.0;
  TrajectoryRules rules;
  rules.alignment = Alignment::kRigid;
  const auto evaluation = evaluate_trajectory(estimate, truth, rules);
  EXPECT_NEAR(evaluation.T_truth_estimate.x_m, -0.25, 1e-12);
  EXPECT_NEAR(evaluation.T_truth_estimate.y_m, 0.0, 1e-12);
  EXPECT_NEAR(evaluation.position_m.rmse, std::sqrt(0.75 / 4.0), 1e-12);
  // no small motion beside it is better
  for (const double step : {-1e-3, 1e-3}) {
    for (int k = 0; k < 3; ++k) {
      const geometry::Pose2 t = evaluation.T_truth_estimate;
      const Track other = moved(estimate, t.x_m + (k == 0) * step, t.y_m + (k == 1) * step,
                                t.yaw_rad + (k == 2) * step);
      EXPECT_GT(evaluate_trajectory(other, truth, {}).position_m.rmse, evaluation.position_m.rmse);
    }
  }
}

TEST(EvaluateTrajectory, RelativeErrorsIgnoreWhereItBegan) {
  const auto evaluation = evaluate_trajectory(moved(bend(), 50.0, -20.0, 1.0), bend(), {});
  EXPECT_EQ(evaluation.relative_position_m.num, 3);
  EXPECT_NEAR(evaluation.relative_position_m.max, 0.0, 1e-9);
  EXPECT_NEAR(evaluation.relative_yaw_rad.max, 0.0, 1e-9);
}

TEST(EvaluateTrajectory, RelativeErrorsAreThoseOfTheMotions) {
  // 10 % too long a scale and 0.02 rad of turn in every step
  Track estimate;
  TrackPose pose;
  for (int i = 0; i < 9; ++i) {
    pose.utime = i * 1000000;
    estimate.poses.push_back(pose);
    pose.x_m += 1.1 * std::cos(pose.yaw_rad);
    pose.y_m += 1.1 * std::sin(pose.yaw_rad);
    pose.yaw_rad += 0.02;
  }
  TrajectoryRules rules;
  auto evaluation = evaluate_trajectory(estimate, straight(9), rules);
  EXPECT_EQ(evaluation.relative_position_m.num, 7);
  EXPECT_NEAR(evaluation.relative_position_m.rmse, 0.1, 1e-9);
  EXPECT_NEAR(evaluation.relative_position_m.sd, 0.0, 1e-6);
  EXPECT_NEAR(evaluation.relative_yaw_rad.rmse, 0.02, 1e-9);
  // two steps: (1.1 + 1.1 cos 0.02 - 2, 1.1 sin 0.02)
  rules.delta_m = 2.0;
  evaluation = evaluate_trajectory(estimate, straight(9), rules);
  EXPECT_EQ(evaluation.relative_position_m.num, 3);
  EXPECT_NEAR(evaluation.relative_position_m.rmse,
              std::hypot(1.1 + 1.1 * std::cos(0.02) - 2.0, 1.1 * std::sin(0.02)), 1e-9);
  EXPECT_NEAR(evaluation.relative_yaw_rad.max, 0.04, 1e-9);
  // 3.2 m of the estimate are reached after three steps (3.3 m); evo begins at the first end
  rules.delta_m = 3.2;
  evaluation = evaluate_trajectory(estimate, straight(9), rules);
  EXPECT_EQ(evaluation.relative_yaw_rad.num, 1);  // 3 -> 6
  EXPECT_NEAR(evaluation.relative_yaw_rad.max, 0.06, 1e-9);
}

TEST(EvaluateTrajectory, TruthNeedsNoHeadings) {
  Track truth = bend();
  truth.has_yaw = false;
  for (TrackPose& pose : truth.poses) pose.yaw_rad = 0.0;
  Track estimate = moved(bend(), 1.0, 2.0, 0.5);
  estimate.poses.back().y_m += 0.0;
  TrajectoryRules rules;
  rules.alignment = Alignment::kRigid;
  const auto evaluation = evaluate_trajectory(estimate, truth, rules);
  EXPECT_FALSE(evaluation.has_yaw);
  EXPECT_NEAR(evaluation.position_m.max, 0.0, 1e-9);
  EXPECT_EQ(evaluation.yaw_rad.num, 0);
  EXPECT_EQ(evaluation.relative_yaw_rad.num, 0);
  EXPECT_EQ(evaluation.relative_position_m.num, 3);
  EXPECT_NEAR(evaluation.relative_position_m.max, 0.0, 1e-9);
}

TEST(EvaluateTrajectory, RefusesDisorderAndNonsense) {
  const Track backwards = track({{2, 0, 0, 0}, {1, 0, 0, 0}});
  EXPECT_THROW(evaluate_trajectory(backwards, straight(2), {}), std::invalid_argument);
  EXPECT_THROW(evaluate_trajectory(straight(2), backwards, {}), std::invalid_argument);
  TrajectoryRules rules;
  rules.delta_m = 0.0;
  EXPECT_THROW(evaluate_trajectory(straight(2), straight(2), rules), std::invalid_argument);
  rules = {};
  rules.gap_max_s = -1.0;
  EXPECT_THROW(evaluate_trajectory(straight(2), straight(2), rules), std::invalid_argument);
  // too little to judge is no error and no figure
  const auto nothing = evaluate_trajectory(track({{99000000, 0, 0, 0}}), straight(2), {});
  EXPECT_EQ(nothing.position_m.num, 0);
  EXPECT_EQ(nothing.num_outside, 1);
  const auto one = evaluate_trajectory(track({{0, 0, 0, 0}}), straight(2), {});
  EXPECT_EQ(one.position_m.num, 1);
  EXPECT_EQ(one.relative_position_m.num, 0);
}

}  // namespace
}  // namespace orchard::evaluation
