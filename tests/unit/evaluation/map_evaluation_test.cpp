// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace orchard::evaluation {
namespace {

using detection::Label;
using mapping::Landmark;
using simulation::TruthObject;

TruthObject thing(Label label, double x_m, double y_m) {
  TruthObject object;
  object.label = label;
  object.x_m = x_m;
  object.y_m = y_m;
  object.width_m = 0.09;
  return object;
}

Landmark landmark(int id, Label label, double x_m, double y_m) {
  Landmark found;
  found.id = id;
  found.label = label;
  found.num_observations = 5;
  found.x_m = x_m;
  found.y_m = y_m;
  found.se_x_m = 0.004;
  found.se_y_m = 0.006;
  found.roc_mean = 0.8;
  return found;
}

TEST(EvaluateMap, ErrorsAreThoseOfThePlaces) {
  const std::vector<TruthObject> truth{thing(Label::kTree, 1.0, 2.0),
                                       thing(Label::kTree, 5.0, 0.0)};
  const std::vector<Landmark> map{landmark(4, Label::kTree, 5.0, -0.005),
                                  landmark(9, Label::kTree, 1.003, 2.004)};
  const MapEvaluation evaluation = evaluate_map(map, truth, 0.3);
  EXPECT_TRUE(evaluation.perfect());
  EXPECT_EQ(evaluation.objects[0].landmark->id, 9);
  EXPECT_NEAR(evaluation.objects[0].error_x_m, 0.003, 1e-12);
  EXPECT_NEAR(evaluation.objects[0].error_y_m, 0.004, 1e-12);
  EXPECT_NEAR(evaluation.objects[0].error_m, 0.005, 1e-12);
  EXPECT_NEAR(evaluation.all.rms_m, 0.005, 1e-12);
  EXPECT_NEAR(evaluation.all.max_m, 0.005, 1e-12);
  EXPECT_NEAR(evaluation.se_x_mean_m, 0.004, 1e-12);
  EXPECT_NEAR(evaluation.se_y_mean_m, 0.006, 1e-12);
  EXPECT_NEAR(evaluation.roc_mean_trees, 0.8, 1e-12);
}

TEST(EvaluateMap, RmsWeighsLargeErrorsMoreThanTheMean) {
  const std::vector<TruthObject> truth{thing(Label::kTree, 0.0, 0.0),
                                       thing(Label::kTree, 5.0, 0.0)};
  const std::vector<Landmark> map{landmark(1, Label::kTree, 0.03, 0.0),
                                  landmark(2, Label::kTree, 5.0, 0.04)};
  const MapEvaluation evaluation = evaluate_map(map, truth, 0.3);
  EXPECT_NEAR(evaluation.all.mean_m, 0.035, 1e-12);
  EXPECT_NEAR(evaluation.all.rms_m, std::sqrt((0.0009 + 0.0016) / 2.0), 1e-12);
}

TEST(EvaluateMap, NamesFollowTheOrderOfTheTruth) {
  const MapEvaluation evaluation = evaluate_map(
      {}, {thing(Label::kTree, 0, 0), thing(Label::kObject, 1, 0), thing(Label::kTree, 2, 0)}, 0.3);
  EXPECT_EQ(evaluation.objects[0].truth.name, "T1");
  EXPECT_EQ(evaluation.objects[1].truth.name, "B1");
  EXPECT_EQ(evaluation.objects[2].truth.name, "T2");
}

TEST(EvaluateMap, CountsMissedExtraAndConfused) {
  const std::vector<TruthObject> truth{thing(Label::kTree, 0, 0), thing(Label::kTree, 5, 0),
                                       thing(Label::kObject, 10, 0)};
  const std::vector<Landmark> map{
      landmark(1, Label::kObject, 0.01, 0), landmark(2, Label::kTree, 10.01, 0),
      landmark(3, Label::kTree, 10.2, 0), landmark(4, Label::kUnseen, 20, 0)};
  const MapEvaluation evaluation = evaluate_map(map, truth, 0.3);
  EXPECT_FALSE(evaluation.perfect());
  EXPECT_EQ(evaluation.num_trees, 2);
  EXPECT_EQ(evaluation.num_objects, 1);
  EXPECT_EQ(evaluation.num_missed, 1);
  EXPECT_EQ(evaluation.num_wrong_class, 2);
  EXPECT_EQ(evaluation.confusion[1][2], 1);
  EXPECT_EQ(evaluation.confusion[2][1], 1);
  ASSERT_EQ(evaluation.extra.size(), 2u);
  EXPECT_EQ(evaluation.extra[0].id, 3);  // the doubled one; the nearer stands for the object
  EXPECT_EQ(evaluation.extra[1].id, 4);
}

TEST(EvaluateMap, ADoubledTreeIsNotPerfect) {
  const MapEvaluation evaluation =
      evaluate_map({landmark(1, Label::kTree, 0, 0), landmark(2, Label::kTree, 0.1, 0)},
                   {thing(Label::kTree, 0, 0)}, 0.3);
  EXPECT_EQ(evaluation.num_missed, 0);
  EXPECT_FALSE(evaluation.perfect());
}

TEST(EvaluateMap, EmptyMapMissesEverything) {
  const MapEvaluation evaluation = evaluate_map({}, {thing(Label::kTree, 0, 0)}, 0.3);
  EXPECT_EQ(evaluation.num_missed, 1);
  EXPECT_EQ(evaluation.all.num, 0);
  EXPECT_EQ(evaluation.all.rms_m, 0.0);
}

TEST(EvaluateMap, RefusesTruthWithoutClass) {
  EXPECT_THROW(evaluate_map({}, {thing(Label::kUnseen, 0, 0)}, 0.3), std::invalid_argument);
}

}  // namespace
}  // namespace orchard::evaluation
