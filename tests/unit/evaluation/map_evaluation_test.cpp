// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/map_evaluation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <stdexcept>

#include "evaluation/assignment.hpp"
#include "experiments/detections/reliability.hpp"
#include "simulation/random.hpp"
#include "worlds/landmark.hpp"

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
  Landmark found = test::landmark(id, label, x_m, y_m, 0.0, 5);
  found.se_x_m = 0.004;
  found.se_y_m = 0.006;
  found.roc_mean = 0.8;
  return found;
}

TEST(EvaluateMap, HeightsAreJudgedWhereBothKnowThem) {
  std::vector<TruthObject> truth{thing(Label::kTree, 0.0, 0.0), thing(Label::kTree, 5.0, 0.0),
                                 thing(Label::kTree, 9.0, 4.0)};
  std::vector<Landmark> map{landmark(1, Label::kTree, 0.0, 0.0),
                            landmark(2, Label::kTree, 5.0, 0.0),
                            landmark(3, Label::kTree, 9.0, 4.0)};
  truth[0].z_m = 1.0, truth[1].z_m = 2.0;
  map[0].z_m = 1.3, map[0].z_sd_m = 0.1;
  map[1].z_m = 1.9, map[1].z_sd_m = 0.1;
  const MapEvaluation evaluation = evaluate_map(map, truth, 0.3);
  EXPECT_EQ(evaluation.heights.num, 2);
  EXPECT_NEAR(evaluation.heights.rmse, std::sqrt((0.09 + 0.01) / 2), 1e-12);
  EXPECT_NEAR(evaluation.height_nees, (9.0 + 1.0) / 2, 1e-9);
  const MapEvaluation aligned = evaluate_aligned_map(map, truth, 0.3);
  EXPECT_NEAR(aligned.heights.rmse, 0.2, 1e-9) << "without the mean of 0.1 m";
  for (TruthObject& object : truth) object.z_m = std::nan("");  // as read without the column
  EXPECT_EQ(evaluate_map(map, truth, 0.3).heights.num, 0);
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
  EXPECT_NEAR(evaluation.all.rmse, 0.005, 1e-12);
  EXPECT_NEAR(evaluation.all.max, 0.005, 1e-12);
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
  EXPECT_NEAR(evaluation.all.mean, 0.035, 1e-12);
  EXPECT_NEAR(evaluation.all.rmse, std::sqrt((0.0009 + 0.0016) / 2.0), 1e-12);
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
  EXPECT_EQ(evaluation.all.rmse, 0.0);
}

TEST(EvaluateMap, RefusesTruthWithoutClass) {
  EXPECT_THROW(evaluate_map({}, {thing(Label::kUnseen, 0, 0)}, 0.3), std::invalid_argument);
}

using ::testing::HasSubstr;

/// The first lines of the paper's own tables 1 and 2 and a tree that nobody found.
MapEvaluation example() {
  std::vector<simulation::TruthObject> truth(3);
  truth[0].label = Label::kTree;
  truth[1].label = Label::kTree;
  truth[1].x_m = 9.0;
  truth[2].label = Label::kObject;
  truth[2].x_m = 4.0;
  std::vector<mapping::Landmark> map(2);
  map[0].id = 1;
  map[0].label = Label::kTree;
  map[0].num_observations = 5;
  map[0].x_m = 0.012;
  map[0].roc_mean = 0.903;
  map[0].se_x_m = 0.00640;
  map[0].se_y_m = 0.00833;
  map[1] = map[0];
  map[1].id = 2;
  map[1].x_m = 4.0;
  map[1].label = Label::kObject;
  map[1].roc_mean = 0.0009;
  map[1].se_x_m = 0.00295;
  map[1].se_y_m = 0.00541;
  return evaluate_map(map, truth, 0.3);
}

TEST(PaperTables, ShowThePapersColumnsAndTheError) {
  EXPECT_EQ(paper_tables(example()),
            "Table 1: the trees\n"
            "Tree        N  ROC_tree_mean  SE_x (mm)  SE_y (mm)  error against truth (mm)\n"
            "T1          5          0.903       6.40       8.33                     12.00\n"
            "T2          -   missed\n"
            "mean                   0.903       6.40       8.33                     12.00\n"
            "\n"
            "Table 2: the other objects\n"
            "Object      N  ROC_tree_mean  SE_x (mm)  SE_y (mm)  error against truth (mm)\n"
            "B1          5         0.0009       2.95       5.41                      0.00\n"
            "mean                  0.0009       2.95       5.41                      0.00\n");
}

TEST(PaperTables, SayWhenTheClassIsWrong) {
  MapEvaluation evaluation = example();
  evaluation.objects[0].landmark->label = Label::kObject;
  EXPECT_THAT(paper_tables(evaluation), HasSubstr("12.00   mapped as object\n"));
}

TEST(EvaluationSummary, CountsAndMeasures) {
  const std::string text = evaluation_summary(example());
  EXPECT_THAT(text, HasSubstr("found 2 of 3 (2 trees, 1 objects) within 0.30 m"));
  EXPECT_THAT(text, HasSubstr("RMS 8.49 mm"));  // sqrt((12^2 + 0^2) / 2)
}

TEST(EvaluationJson, CarriesTheSameNumbers) {
  const auto json = nlohmann::json::parse(evaluation_json(example()));
  EXPECT_EQ(json["num_missed"], 1);
  EXPECT_EQ(json["perfect"], false);
  EXPECT_EQ(json["objects"][0]["name"], "T1");
  EXPECT_NEAR(json["objects"][0]["error_m"].get<double>(), 0.012, 1e-12);
  EXPECT_EQ(json["objects"][1]["found"], false);
  EXPECT_EQ(json["confusion"]["object"]["object"], 1);
}

struct Score {
  int num_pairs = 0;
  double sum_m2 = 0.0;
};

double uniform(std::mt19937_64& engine, double lo, double hi) {
  return lo + (hi - lo) * static_cast<double>(engine() >> 11) * 0x1p-53;
}

double squared_distance_m2(const Point& a, const Point& b) {
  return (a.x_m - b.x_m) * (a.x_m - b.x_m) + (a.y_m - b.y_m) * (a.y_m - b.y_m);
}

/// The best pairing by trying every one: the definition itself.
void search(const std::vector<Point>& truth, const std::vector<Point>& found, double gate_m,
            std::size_t t, std::vector<bool>& used, Score score, Score& best) {
  if (t == truth.size()) {
    if (score.num_pairs > best.num_pairs ||
        (score.num_pairs == best.num_pairs && score.sum_m2 < best.sum_m2)) {
      best = score;
    }
    return;
  }
  search(truth, found, gate_m, t + 1, used, score, best);
  for (std::size_t f = 0; f < found.size(); ++f) {
    const double distance_m2 = squared_distance_m2(truth[t], found[f]);
    if (used[f] || distance_m2 > gate_m * gate_m) continue;
    used[f] = true;
    search(truth, found, gate_m, t + 1, used, {score.num_pairs + 1, score.sum_m2 + distance_m2},
           best);
    used[f] = false;
  }
}

Score score_of(const std::vector<Point>& truth, const std::vector<Point>& found,
               const Assignment& assignment) {
  Score score;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (assignment[t] == kUnmatched) continue;
    ++score.num_pairs;
    score.sum_m2 += squared_distance_m2(truth[t], found[static_cast<std::size_t>(assignment[t])]);
  }
  return score;
}

TEST(Assign, IsAsGoodAsTryingEveryPairing) {
  std::mt19937_64 engine(7);
  for (int round = 0; round < 300; ++round) {
    std::vector<Point> truth(engine() % 6);
    std::vector<Point> found(engine() % 7);
    for (Point& p : truth) p = {uniform(engine, 0, 1), uniform(engine, 0, 1)};
    for (Point& p : found) p = {uniform(engine, 0, 1), uniform(engine, 0, 1)};
    const double gate_m = uniform(engine, 0.05, 0.8);
    Score best;
    std::vector<bool> used(found.size(), false);
    search(truth, found, gate_m, 0, used, {}, best);
    const Score got = score_of(truth, found, assign(truth, found, gate_m));
    EXPECT_EQ(got.num_pairs, best.num_pairs) << "round " << round;
    EXPECT_NEAR(got.sum_m2, best.sum_m2, 1e-12) << "round " << round;
  }
}

TEST(Assign, UsesEachFoundPointOnceAndKeepsToTheGate) {
  std::mt19937_64 engine(11);
  std::vector<Point> truth(400);
  std::vector<Point> found(500);
  for (Point& p : truth) p = {uniform(engine, 0, 30), uniform(engine, 0, 30)};
  for (Point& p : found) p = {uniform(engine, 0, 30), uniform(engine, 0, 30)};
  const Assignment assignment = assign(truth, found, 0.5);
  std::vector<int> uses(found.size(), 0);
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (assignment[t] == kUnmatched) continue;
    const auto f = static_cast<std::size_t>(assignment[t]);
    EXPECT_EQ(++uses[f], 1);
    EXPECT_LE(squared_distance_m2(truth[t], found[f]), 0.25);
  }
}

TEST(Assign, DoesNotDependOnTheOrderOfPoints) {
  std::mt19937_64 engine(3);
  std::vector<Point> truth(60);
  std::vector<Point> found(70);
  for (Point& p : truth) p = {uniform(engine, 0, 3), uniform(engine, 0, 3)};
  for (Point& p : found) p = {uniform(engine, 0, 3), uniform(engine, 0, 3)};
  const Assignment straight = assign(truth, found, 0.4);
  std::vector<Point> reversed(found.rbegin(), found.rend());
  const Assignment backwards = assign(truth, reversed, 0.4);
  const auto num_found = static_cast<std::ptrdiff_t>(found.size());
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const auto expected = straight[t] == kUnmatched ? kUnmatched : num_found - 1 - straight[t];
    EXPECT_EQ(backwards[t], expected);
  }
}

TEST(Assign, MorePairsBeatCloserPairs) {
  // Nearest first would give the middle point to truth 0 and leave truth 1 without any.
  const std::vector<Point> truth{{0.0, 0.0}, {1.0, 0.0}};
  const std::vector<Point> found{{-0.9, 0.0}, {0.45, 0.0}};
  EXPECT_EQ(assign(truth, found, 1.0), (Assignment{0, 1}));
}

TEST(Assign, NothingToMatch) {
  EXPECT_TRUE(assign({}, {{0, 0}}, 1.0).empty());
  EXPECT_EQ(assign({{0, 0}}, {}, 1.0), Assignment{kUnmatched});
  EXPECT_EQ(assign({{0, 0}}, {{2, 0}}, 1.0), Assignment{kUnmatched});
}

TEST(Assign, RefusesWhatCannotBe) {
  EXPECT_THROW(assign({}, {}, 0.0), std::invalid_argument);
  EXPECT_THROW(assign({}, {}, std::nan("")), std::invalid_argument);
  EXPECT_THROW(assign({{std::nan(""), 0}}, {}, 1.0), std::invalid_argument);
  EXPECT_THROW(assign({}, {{0, std::numeric_limits<double>::infinity()}}, 1.0),
               std::invalid_argument);
}

TEST(Reliability, ByHand) {
  // bin 0.2-0.3: mean 0.25, half came true; bin 0.9-1: mean 0.95, all came true
  const Reliability r = reliability({{0.24, true}, {0.26, false}, {0.9, true}, {1.0, true}});
  EXPECT_EQ(r.num, 4);
  EXPECT_EQ(r.bins[2].num, 2);
  EXPECT_DOUBLE_EQ(r.bins[2].mean_probability, 0.25);
  EXPECT_DOUBLE_EQ(r.bins[2].frequency, 0.5);
  EXPECT_EQ(r.bins[9].num, 2);
  EXPECT_NEAR(r.expected_calibration_error, 0.5 * 0.25 + 0.5 * 0.05, 1e-12);
  EXPECT_NEAR(r.brier_score, (0.76 * 0.76 + 0.26 * 0.26 + 0.01) / 4.0, 1e-12);
}

TEST(Reliability, HonestForecastsHaveNoErrorAndBoastfulOnesDo) {
  simulation::Random random(5);
  std::vector<Forecast> honest, boastful;
  for (int i = 0; i < 20000; ++i) {
    const double p = random.uniform();
    const bool came_true = random.uniform() < p;
    honest.push_back({p, came_true});
    boastful.push_back({p < 0.5 ? 0.5 * p : 1.0 - 0.5 * (1.0 - p), came_true});
  }
  EXPECT_LT(reliability(honest).expected_calibration_error, 0.015);
  EXPECT_NEAR(reliability(boastful).expected_calibration_error, 0.125, 0.015);
}

TEST(Reliability, Refuses) {
  EXPECT_EQ(reliability({}).expected_calibration_error, 0.0);
  EXPECT_THROW(reliability({{1.1, true}}), std::invalid_argument);
  EXPECT_THROW(reliability({}, 0), std::invalid_argument);
}

}  // namespace

}  // namespace orchard::evaluation
