// SPDX-License-Identifier: BSD-3-Clause
#include "pose/prior_map/prior_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "pose/prior_map/local_map.hpp"
#include "pose/prior_map/tracker.hpp"
#include "unit/pose/prior_map/prior_world.hpp"

namespace orchard::pose {
namespace {

std::vector<PriorLandmark> scaled(std::vector<PriorLandmark> landmarks, double factor,
                                  double width_factor) {
  for (PriorLandmark& l : landmarks) {
    l.p_map *= factor;
    l.width_m *= width_factor;
  }
  return landmarks;
}

TEST(PriorMapProblem, AnOrchardInMetresHasNone) {
  EXPECT_EQ(problem_with(prior_world(1).trees), "");
}

TEST(PriorMapProblem, NamesAnEmptyMapAndOneOfTwoTrees) {
  EXPECT_NE(problem_with({}).find("no landmark"), std::string::npos);
  const auto trees = prior_world(1).trees;
  EXPECT_NE(problem_with({trees[0], trees[1]}).find("only 2"), std::string::npos);
}

TEST(PriorMapProblem, NamesOtherUnits) {
  const auto trees = prior_world(1).trees;
  EXPECT_NE(problem_with(scaled(trees, 1000.0, 1000.0)).find("not in metres"), std::string::npos);
  EXPECT_NE(problem_with(scaled(trees, 1000.0, 1.0)).find("not in metres"), std::string::npos);
  EXPECT_NE(problem_with(scaled(trees, 1.0, 1000.0)).find("not in metres"), std::string::npos);
  EXPECT_NE(problem_with(scaled(trees, 0.001, 0.001)).find("not in metres"), std::string::npos);
}

TEST(PriorMapProblem, NamesWhatIsNoNumber) {
  auto trees = prior_world(1).trees;
  trees[3].p_map.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(problem_with(trees), "");
  trees = prior_world(1).trees;
  trees[3].width_m = std::numeric_limits<double>::infinity();
  EXPECT_NE(problem_with(trees), "");
}

TEST(WithoutDoubles, ATreeMappedFromBothSidesIsOneAndNeighboursStayTwo) {
  const std::vector<PriorLandmark> landmarks{{{1.0, 2.0}, 0.10, 30.0},
                                             {{4.0, 2.0}, 0.12, 5.0},
                                             {{1.0, 2.3}, 0.13, 60.0},
                                             {{4.6, 2.0}, 0.2, 5.0}};
  const auto merged = without_duplicates(landmarks);
  ASSERT_EQ(merged.size(), 3u);
  EXPECT_NEAR(merged[0].p_map.y(), 2.2, 1e-12);  // twice as often seen there
  EXPECT_NEAR(merged[0].width_m, 0.12, 1e-12);
  EXPECT_EQ(merged[1].p_map.x(), 4.0);
  EXPECT_EQ(merged[2].p_map.x(), 4.6);
}

TEST(PriorMap, FindsEveryPairAtADistance) {
  const auto trees = prior_world(2).trees;
  const PriorMap map(trees, 8.0);
  for (const double distance_m : {2.5, 4.0, 6.3}) {
    std::set<std::pair<std::int32_t, std::int32_t>> expected, found;
    for (std::size_t i = 0; i < trees.size(); ++i) {
      for (std::size_t j = i + 1; j < trees.size(); ++j) {
        const double apart_m = (trees[j].p_map - trees[i].p_map).norm();
        if (std::abs(apart_m - distance_m) < 0.2) expected.emplace(i, j);
      }
    }
    const auto [begin, end] = map.pairs_at(distance_m - 0.2, distance_m + 0.2);
    for (std::size_t k = begin; k < end; ++k) {
      found.emplace(map.pairs()[k].first, map.pairs()[k].second);
    }
    EXPECT_EQ(found, expected) << distance_m;
  }
}

TEST(PriorMap, NothingNearAPointIsLeftOut) {
  const auto trees = prior_world(3).trees;
  const PriorMap map(trees, 8.0);
  for (const Eigen::Vector2d& p : {Eigen::Vector2d(10.2, 7.9), Eigen::Vector2d(-1.0, -0.5)}) {
    std::set<std::int32_t> found;
    map.near(p, 5.6, [&](std::int32_t i) { EXPECT_TRUE(found.insert(i).second); });
    for (std::size_t i = 0; i < trees.size(); ++i) {
      if ((trees[i].p_map - p).norm() > 5.6) continue;
      EXPECT_EQ(found.count(static_cast<std::int32_t>(i)), 1u);
    }
  }
}

TEST(PriorMap, WorksFarFromTheOrigin) {
  auto trees = prior_world(3).trees;
  for (PriorLandmark& l : trees) l.p_map += Eigen::Vector2d(-395000.0, 6950000.0);  // UTM
  const PriorMap map(trees, 8.0);
  EXPECT_NEAR(map.spacing_m(), 2.4, 0.3);
  int num = 0;
  map.near(trees[7].p_map, 0.01, [&](std::int32_t i) { num += i == 7; });
  EXPECT_EQ(num, 1);
}

ScanObservation at(double x_m, double y_m, double width_m) {
  ScanObservation s;
  s.p_base = {x_m, y_m};
  s.width_m = width_m;
  return s;
}

TEST(FieldOfView, LearnsWhereTheScannerObservationsAndHowFar) {
  FieldOfView field(4.0);
  EXPECT_FALSE(field.covers({2.0, 0.0}));
  for (int i = 0; i < 20; ++i) field.learn({at(3.0, 0.1, 0.1)});
  EXPECT_TRUE(field.covers({2.0, 0.05}));
  EXPECT_FALSE(field.covers({2.9, 0.1})) << "nearly as far as anything was seen";
  EXPECT_FALSE(field.covers({-2.0, 0.05})) << "behind, where nothing was ever seen";
  for (int i = 0; i < 20; ++i) field.learn({at(9.0, 0.1, 0.1)});
  EXPECT_FALSE(field.covers({5.0, 0.1})) << "beyond sure_range_m";
}

TEST(SightingsAtScan, AreMovedToTheScansTimeAndWhatIsNoNumberIsLeftOut) {
  detection::Detections seen;
  seen.utime = 1'000'000;
  detection::Detection trunk;
  trunk.utime = 1'100'000;
  trunk.centre_x_m = 3.0;
  trunk.centre_y_m = 1.0;
  trunk.covariance = {1e-4, 0.0, 1e-4};
  trunk.width_m = 0.1;
  seen.trunks.push_back(trunk);
  trunk.centre_x_m = std::numeric_limits<double>::quiet_NaN();
  seen.trunks.push_back(trunk);
  trunk.centre_x_m = 3.0;
  trunk.covariance[2] = -1.0;
  seen.trunks.push_back(trunk);
  const auto observations = scan_observations(seen, 2.0, 0.0, {});
  ASSERT_EQ(observations.size(), 1u);
  // 0.1 s earlier the robot was 0.2 m further back
  EXPECT_NEAR(observations[0].p_base.x(), 3.2, 1e-9);
  EXPECT_NEAR(observations[0].p_base.y(), 1.0, 1e-9);
}

TEST(TreeDetectionMonitor, CountsTreesNotSightings) {
  TreeDetectionMonitor watch;
  for (int scan = 0; scan < 10; ++scan) watch.add({{5, false}, {9, scan % 10 != 0}, {7, true}});
  EXPECT_EQ(watch.count().num_trees, 3);
  EXPECT_EQ(watch.count().num_detected, 2);
  for (int scan = 0; scan < 9; ++scan) watch.add({});
  EXPECT_EQ(watch.count().num_trees, 0);
}

}  // namespace
}  // namespace orchard::pose
