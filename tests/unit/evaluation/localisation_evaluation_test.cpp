// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/localisation_evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace orchard::evaluation {
namespace {

/// A true pose a second, at 2 m/s along x.
Track straight(int num) {
  Track track;
  for (int i = 0; i < num; ++i) track.poses.push_back({1000000 * i, 2.0 * i, 0.0, 0.0});
  return track;
}

/// The pose of that second, off by dx and dy, claiming an sd on each axis.
pose::PoseEstimate pose_at(int second, double dx_m, double dy_m, double sd_m) {
  pose::PoseEstimate pose;
  pose.utime = 1000000 * second;
  pose.x_m = 2.0 * second + dx_m;
  pose.y_m = dy_m;
  pose.covariance = {sd_m * sd_m, 0.0, 0.0, sd_m * sd_m, 0.0, 0.01};
  return pose;
}

TEST(EvaluateLocalisation, CountsTimeAndWayWithinEachError) {
  ShadowRun run;
  // seconds 0-3 lost, 4-5 ambiguous, 6-10 off by 0.05 m, 11-14 by 0.2 m, 15-19 by 0.4 m
  run.states = {
      {0, PlaceState::kLost}, {4000000, PlaceState::kAmbiguous}, {6000000, PlaceState::kPlaced}};
  for (int i = 6; i < 20; ++i) {
    run.poses.push_back(pose_at(i, 0.0, i < 11 ? 0.05 : i < 15 ? 0.2 : 0.4, 0.1));
  }
  const LocalisationEvaluation e = evaluate_localisation(run, straight(20), 0.0);
  EXPECT_NEAR(e.time_s, 19.0, 1e-9);
  EXPECT_NEAR(e.way_m, 38.0, 1e-9);
  EXPECT_NEAR(e.lost_s, 3.0, 1e-9);  // the steps that end at 1, 2, 3
  EXPECT_NEAR(e.ambiguous_s, 2.0, 1e-9);
  EXPECT_NEAR(e.placed_s, 14.0, 1e-9);
  EXPECT_NEAR(e.placed_m, 28.0, 1e-9);
  EXPECT_NEAR(*e.first_s, 6.0, 1e-9);
  EXPECT_NEAR(*e.first_m, 12.0, 1e-9);
  EXPECT_NEAR(e.within[0].time_s, 5.0, 1e-9);
  EXPECT_NEAR(e.within[1].time_s, 9.0, 1e-9);
  EXPECT_NEAR(e.within[1].longest_m, 18.0, 1e-9);
  EXPECT_NEAR(e.within[2].time_s, 14.0, 1e-9);
  EXPECT_NEAR(e.position_m.rmse, std::sqrt((5 * 0.0025 + 4 * 0.04 + 5 * 0.16) / 14), 1e-9);
  EXPECT_EQ(e.wrong_s, 0.0);
}

TEST(EvaluateLocalisation, AWrongPlaceIsWrongOnlyWhereItIsNotClaimed) {
  ShadowRun run;
  run.states = {{0, PlaceState::kPlaced}};
  // 1 m off: claimed as 1 m, then for six seconds as 0.05 m, for one as 1 m, for two as 0.05 m
  for (int i = 0; i < 12; ++i) {
    const bool claims_little = (i >= 3 && i < 9) || i >= 10;
    run.poses.push_back(pose_at(i, 0.0, 1.0, claims_little ? 0.05 : 1.0));
  }
  const LocalisationEvaluation e = evaluate_localisation(run, straight(12), 0.0);
  EXPECT_NEAR(e.wrong_s, 8.0, 1e-9);
  EXPECT_NEAR(e.wrong_longest_s, 6.0, 1e-9);
  EXPECT_NEAR(e.wrong_m, 16.0, 1e-9);
  EXPECT_EQ(e.within[2].time_s, 0.0);
}

TEST(EvaluateLocalisation, NeesIsTheErrorByClaimAndTruth) {
  ShadowRun run;
  run.states = {{0, PlaceState::kPlaced}};
  for (int i = 0; i < 10; ++i) run.poses.push_back(pose_at(i, 0.3, i < 5 ? 0.0 : 0.4, 0.3));
  EXPECT_NEAR(evaluate_localisation(run, straight(10), 0.0).nees, 0.5 * (0.09 + 0.25) / 0.09, 1e-9);
  const LocalisationEvaluation e = evaluate_localisation(run, straight(10), 0.4);
  EXPECT_NEAR(e.nees, 0.5 * (0.09 + 0.25) / 0.25, 1e-9);
  EXPECT_NEAR(e.sd_m, 0.3 * std::sqrt(2.0), 1e-9);
  EXPECT_EQ(e.nees_share, 1.0);
  EXPECT_NEAR(e.moments[3].sd_m, 0.3, 1e-9);
}

TEST(EvaluateLocalisation, APoseBetweenIsInterpolatedButNotWhileLost) {
  ShadowRun run;  // a pose every four seconds, lost from just after the one at 8 until that at 16
  run.states = {
      {0, PlaceState::kPlaced}, {8000001, PlaceState::kLost}, {16000000, PlaceState::kPlaced}};
  for (int i = 0; i <= 20; i += 4) run.poses.push_back(pose_at(i, 0.0, 0.05, 0.1));
  const LocalisationEvaluation e = evaluate_localisation(run, straight(24), 0.0);
  EXPECT_NEAR(e.placed_s, 8.0 + 5.0, 1e-9);  // until 8; 16 to 20
  EXPECT_NEAR(e.position_m.max, 0.05, 1e-9);
  EXPECT_NEAR(e.lost_s, 7.0 + 3.0, 1e-9);  // also after its last pose
}

TEST(EvaluateLocalisation, GapsOfTheTruthCountForNothing) {
  Track truth = straight(10);
  for (std::size_t i = 5; i < 10; ++i) truth.poses[i].utime += 60000000;
  ShadowRun run;
  run.states = {{0, PlaceState::kLost}};
  const LocalisationEvaluation e = evaluate_localisation(run, truth, 0.0);
  EXPECT_NEAR(e.time_s, 8.0, 1e-9);
  EXPECT_NEAR(e.lost_s, 8.0, 1e-9);
  EXPECT_FALSE(e.first_s);
  EXPECT_THAT(localisation_summary(e), testing::HasSubstr("no pose at all"));
}

TEST(EvaluateLocalisation, RefusesWhatItCannotJudge) {
  EXPECT_THROW(evaluate_localisation({}, straight(1), 0.0), std::invalid_argument);
  EXPECT_THROW(evaluate_localisation({}, straight(5), -0.1), std::invalid_argument);
  ShadowRun run;
  run.poses = {pose_at(3, 0, 0, 0.1), pose_at(2, 0, 0, 0.1)};
  EXPECT_THROW(evaluate_localisation(run, straight(5), 0.0), std::invalid_argument);
}

TEST(EvaluateLocalisation, TablesItsMoments) {
  ShadowRun run;
  run.states = {{0, PlaceState::kLost}, {1000000, PlaceState::kPlaced}};
  run.poses = {pose_at(1, 0, 0.25, 0.1), pose_at(2, 0, 0.25, 0.1)};
  const LocalisationEvaluation e = evaluate_localisation(run, straight(3), 0.0);
  EXPECT_EQ(localisation_csv(e),
            "time_s,way_m,state,error_m,sd_m\n0.000,0.000,lost,,\n"
            "1.000,2.000,placed,0.2500,0.1000\n2.000,4.000,placed,0.2500,0.1000\n");
  EXPECT_THAT(localisation_json(e), testing::HasSubstr("\"first_pose_m\": 2.0"));
}

}  // namespace
}  // namespace orchard::evaluation
