// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/paper_tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace orchard::evaluation {
namespace {

using detection::Label;
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

}  // namespace
}  // namespace orchard::evaluation
