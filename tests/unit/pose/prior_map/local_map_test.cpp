// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/local_map.hpp"
#include "geometry/pose2.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "simulation/random.hpp"

namespace orchard::pose {
using geometry::compose;
using geometry::inverse_transform;

namespace {

/// Two rows beside a lane along x.
std::vector<Eigen::Vector2d> trees() {
  std::vector<Eigen::Vector2d> trees;
  simulation::Random random(4);
  for (int i = 0; i < 12; ++i) {
    for (const double y_m : {-2.0, 2.0}) {
      trees.emplace_back(i * 2.5 + random.normal(0.0, 0.2), y_m + random.normal(0.0, 0.2));
    }
  }
  return trees;
}

std::vector<ScanObservation> observe(const std::vector<Eigen::Vector2d>& trees,
                                     const Eigen::Vector3d& T, double sd_m,
                                     simulation::Random& random) {
  std::vector<ScanObservation> observations;
  for (const Eigen::Vector2d& tree : trees) {
    ScanObservation s;
    s.p_base = inverse_transform(T, tree);
    if (s.p_base.norm() > 5.6 || s.p_base.x() < -1.5) continue;
    s.p_base += Eigen::Vector2d(random.normal(0.0, sd_m), random.normal(0.0, sd_m));
    s.covariance = (sd_m * sd_m + 1e-6) * Eigen::Matrix2d::Identity();
    s.width_m = 0.12;
    s.width_sd_m = 0.02;
    observations.push_back(s);
  }
  return observations;
}

struct Drive {
  LocalTrunkMap map{PriorMapConfig()};
  std::vector<Eigen::Vector2d> stand = trees();
  FieldOfView field{4.0};
  Eigen::Vector3d T = Eigen::Vector3d(1.0, 0.1, 0.0);  ///< truth
  simulation::Random random{7};

  void drive(int num_scans, double wheel_scale) {
    for (int i = 0; i < num_scans; ++i) {
      const Eigen::Vector3d step(0.1, 0.0, 0.01 * std::sin(0.1 * i));
      T = compose(T, step);
      Eigen::Vector3d measured = step;
      measured.x() *= wheel_scale;
      const Eigen::Vector3d variances(std::pow(0.005, 2), std::pow(0.001, 2), std::pow(0.002, 2));
      map.move(measured, variances.asDiagonal(), 0.1);
      scan();
    }
  }
  void scan() {
    const auto observations = observe(stand, T, 0.02, random);
    field.learn(observations);
    map.observe(observations, field);
  }
};

TEST(LocalTrunkMap, TrunksStandWhereTheyAreThoughTheWheelsErr) {
  Drive run;
  run.scan();
  run.drive(80, 1.03);
  run.map.reset_origin();
  const auto found = run.map.trunks();
  EXPECT_GE(found.size(), 6u);
  double sum2 = 0.0;
  for (const LocalTrunkMap::Trunk& trunk : found) {
    double nearest_m = 1e9;
    for (const Eigen::Vector2d& tree : trees()) {
      nearest_m = std::min(nearest_m, (inverse_transform(run.T, tree) - trunk.p_local).norm());
    }
    sum2 += nearest_m * nearest_m;
    EXPECT_NEAR(trunk.width_m, 0.12, 1e-9);
  }
  // dead reckoning alone is 0.24 m off after 8 m
  EXPECT_LT(std::sqrt(sum2 / static_cast<double>(found.size())), 0.08);
}

TEST(LocalTrunkMap, AnchoringMovesTheFrameAndNothingElse) {
  Drive run;
  run.drive(40, 1.0);
  const auto before = run.map.trunks();
  const Eigen::Vector3d T = run.map.T_local_base();
  run.map.reset_origin();
  const auto after = run.map.trunks();
  ASSERT_EQ(before.size(), after.size());
  ASSERT_FALSE(before.empty());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_LT((inverse_transform(T, before[i].p_local) - after[i].p_local).norm(), 1e-9);
  }
  EXPECT_EQ(run.map.T_local_base().norm(), 0.0);
  EXPECT_EQ(run.map.pose_covariance().norm(), 0.0);
  // against base, the trunk seen last is known to a scan's noise: centimetres
  EXPECT_LT(after.front().covariance.trace(), 2.0 * 0.03 * 0.03);
}

TEST(LocalTrunkMap, ForgetsWhatLiesBehindTheWindow) {
  Drive run;
  run.drive(220, 1.0);
  for (const LocalTrunkMap::Trunk& trunk : run.map.trunks()) {
    EXPECT_LE(run.map.travel_m() - trunk.last_travel_m, PriorMapConfig().window_m);
  }
  EXPECT_LE(run.map.travel_m() - run.map.views().front().travel_m, PriorMapConfig().window_m);
}

TEST(LocalTrunkMap, WhereMoreStandThanItHoldsItForgetsTheOnesLongestUnseen) {
  // A vineyard: in the window of 15 m stand some ninety stems, more than the filter holds.
  Drive run;
  run.stand.clear();
  for (int i = 0; i < 45; ++i) {
    for (const double y_m : {-2.0, -1.2, 1.2, 2.0}) run.stand.emplace_back(0.8 * i, y_m);
  }
  run.drive(280, 1.0);
  const auto num_around = [&](double ahead_m) {
    const Eigen::Vector2d there(run.map.T_local_base().x() + ahead_m, 0.0);
    const auto trunks = run.map.trunks();
    return std::count_if(trunks.begin(), trunks.end(), [&](const LocalTrunkMap::Trunk& trunk) {
      return (trunk.p_local - there).norm() < 2.5;
    });
  };
  EXPECT_GE(num_around(0.0), 12);
  EXPECT_GE(num_around(2.0), 12);
}

TEST(LocalTrunkMap, BreaksWhenTheRobotWasMoved) {
  Drive run;
  run.drive(60, 1.0);
  EXPECT_FALSE(run.map.is_inconsistent());
  run.T = compose(run.T, {1.2, 0.7, 0.4});
  for (int i = 0; i < 10; ++i) run.scan();
  EXPECT_TRUE(run.map.is_inconsistent());
  run.map.clear();
  EXPECT_FALSE(run.map.is_inconsistent());
  EXPECT_TRUE(run.map.trunks().empty());
}

TEST(LocalTrunkMap, OneScanOfAnotherPlaceSurprises) {
  Drive run;
  for (int i = 0; i < 120; ++i) {
    run.drive(1, 1.0);
    EXPECT_FALSE(run.map.last_scan_contradicts()) << "after scan " << i;
  }
  Drive moved = run;
  moved.T = compose(moved.T, {0.4, 0.3, 0.0});
  moved.scan();
  EXPECT_TRUE(moved.map.last_scan_contradicts());
  // by a whole spacing of the trees: their jitter tells
  moved = run;
  moved.T = compose(moved.T, {-5.0, 0.0, 0.0});
  moved.scan();
  EXPECT_TRUE(moved.map.last_scan_contradicts());
}

TEST(LocalTrunkMap, WhatIsSeenOnceIsNoTrunk) {
  Drive run;
  run.drive(30, 1.0);
  const std::size_t before = run.map.trunks().size();
  ScanObservation passer;
  passer.p_base = {2.0, 0.0};
  passer.covariance = 1e-4 * Eigen::Matrix2d::Identity();
  auto observations = observe(trees(), run.T, 0.02, run.random);
  observations.push_back(passer);
  run.map.observe(observations, run.field);
  EXPECT_EQ(run.map.trunks().size(), before);
}

}  // namespace
}  // namespace orchard::pose
