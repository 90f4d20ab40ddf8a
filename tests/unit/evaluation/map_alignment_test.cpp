// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "evaluation/map_evaluation.hpp"
#include "simulation/random.hpp"
#include "worlds/landmark.hpp"

namespace orchard::evaluation {
namespace {

using detection::Label;
using simulation::Random;
using simulation::TruthObject;

/// Rows of trees that stand as unevenly as planters leave them, some missing.
std::vector<TruthObject> block(std::uint64_t seed, int num_rows, int trees_per_row) {
  Random random(seed);
  std::vector<TruthObject> truth;
  for (int row = 0; row < num_rows; ++row) {
    for (int i = 0; i < trees_per_row; ++i) {
      const double x_m = 4.0 * row + random.uniform(-0.1, 0.1);
      const double y_m = 2.0 * i + random.uniform(-0.15, 0.15);
      if (random.uniform() > 0.08) truth.push_back({Label::kTree, x_m, y_m, 0.12, ""});
    }
  }
  return truth;
}

/// What a map of it says in a frame of its own: T_map_truth, noise, some missed, some invented.
std::vector<mapping::Landmark> map_of(const std::vector<TruthObject>& truth,
                                      const geometry::Pose2& T_map_truth, double sd_m,
                                      Random& random) {
  std::vector<mapping::Landmark> map;
  const auto add = [&](double x_m, double y_m) {
    const Point p = transform(T_map_truth, {x_m, y_m});
    const double at_x_m = p.x_m + random.normal(0.0, sd_m);
    const double at_y_m = p.y_m + random.normal(0.0, sd_m);
    map.push_back(test::tree(static_cast<int>(map.size()) + 1, at_x_m, at_y_m));
  };
  for (const TruthObject& tree : truth) {
    if (random.uniform() > 0.05) add(tree.x_m, tree.y_m);
    if (random.uniform() < 0.05) add(tree.x_m + 1.0, tree.y_m);
  }
  return map;
}

double error_m(const geometry::Pose2& T_truth_map, const geometry::Pose2& T_map_truth, double x_m,
               double y_m) {
  const Point p = transform(T_truth_map, transform(T_map_truth, {x_m, y_m}));
  return std::hypot(p.x_m - x_m, p.y_m - y_m);
}

TEST(MapAlignment, FindsARigidMotionWithoutKnowingWhoIsWho) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const auto truth = block(seed, 8, 20);
    Random random(100 + seed);
    const geometry::Pose2 T_map_truth{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0),
                                      random.uniform(-0.15, 0.15)};
    const auto map = map_of(truth, T_map_truth, 0.05, random);
    const MapEvaluation evaluation = evaluate_aligned_map(map, truth, 0.3);
    ASSERT_TRUE(evaluation.unaligned);
    for (const double y_m : {0.0, 40.0}) {
      EXPECT_LT(error_m(evaluation.unaligned->T_truth_map, T_map_truth, 0.0, y_m), 0.04)
          << "seed " << seed;
    }
    EXPECT_NEAR(evaluation.trees.rmse, 0.05 * std::sqrt(2.0), 0.01);
    EXPECT_LE(evaluation.trees.num, static_cast<int>(truth.size()));
    EXPECT_GT(evaluation.trees.num, static_cast<int>(0.9 * truth.size()));
    EXPECT_EQ(evaluation.num_trees_missed + evaluation.trees.num, evaluation.num_trees);
    EXPECT_EQ(evaluation.num_duplicates, 0);  // what is invented stands a metre away
  }
}

TEST(MapAlignment, APathsGuessReachesFartherThanTheSearch) {
  const auto truth = block(3, 6, 12);
  Random random(7);
  const geometry::Pose2 T_map_truth{55.0, -30.0, 2.6};
  const auto map = map_of(truth, T_map_truth, 0.03, random);
  const MapEvaluation lost = evaluate_aligned_map(map, truth, 0.3);
  EXPECT_GT(lost.num_trees_missed, static_cast<int>(truth.size()) / 2);
  // off by half a metre and a degree, as a path's alignment may be
  const double yaw_rad = -2.6 + 0.02;
  const Point origin = transform(geometry::Pose2{0.0, 0.0, yaw_rad}, {55.0, -30.0});
  const MapEvaluation found = evaluate_aligned_map(
      map, truth, 0.3, {}, geometry::Pose2{0.5 - origin.x_m, -origin.y_m, yaw_rad});
  EXPECT_LT(found.num_trees_missed, static_cast<int>(truth.size()) / 8);
  EXPECT_LT(found.trees.rmse, 0.06);
}

TEST(MapAlignment, LargeMapsAreTurnedFromTheirMiddleOutwards) {
  const auto truth = block(5, 40, 100);
  Random random(9);
  const geometry::Pose2 T_map_truth{1.0, -2.0, 0.05};
  const auto map = map_of(truth, T_map_truth, 0.03, random);
  const MapEvaluation evaluation = evaluate_aligned_map(map, truth, 0.3);
  EXPECT_LT(error_m(evaluation.unaligned->T_truth_map, T_map_truth, 156.0, 198.0), 0.02);
  EXPECT_EQ(evaluation.unaligned->num_trees_found < evaluation.trees.num, true);
}

TEST(MapAlignment, NothingUponNothing) {
  EXPECT_FALSE(align_points({}, {{0, 0}}, 0.3, {}, {}));
  EXPECT_FALSE(align_points({{0, 0}}, {}, 0.3, {}, {}));
  EXPECT_FALSE(align_points({{0, 0}, {5, 0}}, {{100, 0}}, 0.3, {}, {}));
  const MapEvaluation evaluation = evaluate_aligned_map({}, block(1, 2, 3), 0.3);
  EXPECT_EQ(evaluation.num_trees_missed, evaluation.num_trees);
  EXPECT_EQ(evaluation.unaligned->T_truth_map.x_m, 0.0);
}

TEST(MapAlignment, SecondLandmarksOfATreeAreCounted) {
  const std::vector<TruthObject> truth{{Label::kTree, 0.0, 0.0, 0.1, ""},
                                       {Label::kTree, 2.0, 0.0, 0.1, ""},
                                       {Label::kObject, 4.0, 0.0, 0.1, ""}};
  const auto landmark = [](int id, Label label, double x_m) {
    return test::landmark(id, label, x_m, 0.0);
  };
  const MapEvaluation evaluation =
      evaluate_map({landmark(1, Label::kTree, 0.01), landmark(2, Label::kTree, 0.2),
                    landmark(3, Label::kObject, -0.2),  // no tree
                    landmark(4, Label::kTree, 1.2),     // too far from both
                    landmark(5, Label::kTree, 4.0), landmark(6, Label::kTree, 4.1)},
                   truth, 0.3);
  EXPECT_EQ(evaluation.num_duplicates, 1);
  EXPECT_EQ(evaluation.num_trees_missed, 1);  // the one at 2 m
  EXPECT_EQ(evaluation.num_missed, 1);
}

}  // namespace
}  // namespace orchard::evaluation
