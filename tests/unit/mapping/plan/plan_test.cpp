// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "mapping/plan/orchard_plan.hpp"
#include "mapping/plan/plan_match.hpp"
#include "mapping/rows/row_numbers.hpp"
#include "unit/mapping/plan/planned_block.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

DetectionMap seen_by(const DrivenMap& map) { return view_of(map, Drive{}.reach_m); }

TEST(Plan, NamesAndDeviationsAreFound) {
  PlanScore sum;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    Dice dice(seed);
    PlannedBlock b = plant_to_plan(dice, {});
    const DrivenMap map = drive_all(b, {0.8, -0.6, 0.006}, dice);
    const PlanMatch match = match_plan(b.plan, map.landmarks, seen_by(map), {});
    ASSERT_TRUE(match.is_registered()) << "seed " << seed << ": " << match.fit.reason;
    const PlanScore score = score_of(b, map, b.plan, match);
    EXPECT_EQ(score.num_misnamed, 0) << "seed " << seed;
    sum.add(score);
  }
  EXPECT_GE(sum.precision(), 0.98);
  EXPECT_GE(sum.recall(), 0.98);
}

TEST(Plan, LiesOnAMapOfAnotherFrame) {
  Dice dice(7);
  PlannedBlock b = plant_to_plan(dice, {});
  const geometry::Pose2 T{35.0, -20.0, 2.3};
  const DrivenMap map = drive_all(b, T, dice);
  PlanMatchConfig config;
  config.alignment.any_place = true;
  const PlanMatch match = match_plan(b.plan, map.landmarks, seen_by(map), config);
  ASSERT_TRUE(match.is_registered()) << match.fit.reason;
  EXPECT_EQ(score_of(b, map, b.plan, match).num_misnamed, 0);
  // half a decimetre is how far the drive bends its map
  const Eigen::Vector2d p = b.plan.places().front();
  EXPECT_LT((transform(match.T_map_plan(), p) - transform(T, p)).norm(), 0.15);
}

/// Bushes are extra trees, however many there are: the plan is found by its own places.
TEST(Plan, BushesAreExtraHoweverManyThereAre) {
  for (const std::size_t bushes_per_tree : {1, 3}) {
    Dice dice(20 + bushes_per_tree);
    PlannedBlock b = plant_to_plan(dice, {});
    const geometry::Pose2 T{3.0, -2.0, 0.02};
    DrivenMap map = drive_all(b, T, dice);
    add_bushes(b, bushes_per_tree * b.block.trees.size(), T, dice, map);
    for (const bool any_place : {false, true}) {
      PlanMatchConfig config;
      config.alignment.any_place = any_place;
      const PlanMatch match = match_plan(b.plan, map.landmarks, seen_by(map), config);
      ASSERT_TRUE(match.is_registered()) << bushes_per_tree << ": " << match.fit.reason;
      EXPECT_EQ(score_of(b, map, b.plan, match).num_misnamed, 0);
      EXPECT_GE(match.counts[static_cast<std::size_t>(PlanDeviation::kExtra)],
                static_cast<int>(bushes_per_tree * b.block.trees.size()));
    }
  }
}

TEST(Plan, ARectangleThatFitsBothWaysRoundIsRefusedAndCanBeChosen) {
  Dice dice(8);
  Planting planting;
  planting.is_rectangle = true;
  PlannedBlock b = plant_to_plan(dice, planting);
  const DrivenMap map = drive_all(b, {3.0, 4.0, 1.0}, dice);
  PlanMatchConfig config;
  config.alignment.any_place = true;
  const PlanMatch refused = match_plan(b.plan, map.landmarks, seen_by(map), config);
  EXPECT_FALSE(refused.is_registered());
  EXPECT_EQ(refused.fit.status, AlignmentStatus::kAmbiguous);
  ASSERT_EQ(refused.fit.placements.size(), 2u);
  int num_right = 0;
  for (config.placement = 1; config.placement <= 2; ++config.placement) {
    const PlanMatch match = match_plan(b.plan, map.landmarks, seen_by(map), config);
    num_right += score_of(b, map, b.plan, match).num_misnamed == 0;
  }
  EXPECT_EQ(num_right, 1);
  EXPECT_FALSE(
      match_plan(b.plan, map.landmarks, seen_by(map), config).is_registered());  // no third
}

TEST(Plan, AnotherOrchardIsRefused) {
  for (std::uint64_t seed = 9; seed < 15; ++seed) {
    Dice dice(seed);
    PlannedBlock b = plant_to_plan(dice, {});
    OrchardPlan other = b.plan;
    for (PlannedRow& row : other.rows) {
      for (PlannedTree& tree : row.trees) tree.p_plan *= 1.37;
    }
    DrivenMap map = drive_all(b, {}, dice);
    if (seed % 2 == 0) add_bushes(b, b.block.trees.size(), {}, dice, map);
    PlanMatchConfig config;
    config.alignment.any_place = true;
    const PlanMatch match = match_plan(other, map.landmarks, seen_by(map), config);
    EXPECT_FALSE(match.is_registered()) << seed;
    EXPECT_EQ(match.fit.status, AlignmentStatus::kNone) << seed;
  }
}

TEST(Plan, WhereTheDriveDidNotObservationNothingIsMissing) {
  Dice dice(10);
  Planting planting;
  planting.missing = 0.0;
  planting.shift_a_row = false;
  PlannedBlock b = plant_to_plan(dice, planting);
  Drive drive;
  drive.last_aisle = 2;  // of at least six rows
  drive.along_max_m = b.block.num_places * b.block.tree_spacing_m + 3.0;
  const DrivenMap map = drive_through(b.block, drive, dice);
  const PlanMatch match = match_plan(b.plan, map.landmarks, seen_by(map), {});
  ASSERT_TRUE(match.is_registered()) << match.fit.reason;
  EXPECT_EQ(match.counts[static_cast<std::size_t>(PlanDeviation::kMissing)], 0);
  EXPECT_GT(match.counts[static_cast<std::size_t>(PlanDeviation::kNotSeen)], 20);
}

TEST(Plan, GivesTheMapItsNumbersAndItsGaps) {
  Dice dice(11);
  PlannedBlock b = plant_to_plan(dice, {});
  DrivenMap map = drive_all(b, {}, dice);
  const PlanMatch match = match_plan(b.plan, map.landmarks, seen_by(map), {});
  ASSERT_TRUE(match.is_registered()) << match.fit.reason;
  number_by_plan(b.plan, match, map.landmarks);
  const std::vector<Row> rows = numbered_rows(map.landmarks);
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const TrueTree& t = b.block.trees[static_cast<std::size_t>(map.tree_of[i])];
    const PlannedRow& row = b.plan.rows[static_cast<std::size_t>(t.row)];
    const bool is_planned = t.place >= 0;
    EXPECT_EQ(std::to_string(map.landmarks[i].row), is_planned ? row.name : "0");
    const std::string tree = is_planned ? row.trees[static_cast<std::size_t>(t.place)].name : "0";
    EXPECT_EQ(std::to_string(map.landmarks[i].position), tree);
  }
  ASSERT_EQ(rows.size(), b.plan.rows.size());
  int num_gaps = 0;
  for (const Row& row : rows) {
    EXPECT_NE(row.places.front().landmark_id, 0);
    EXPECT_NE(row.places.back().landmark_id, 0);
    for (const RowSlot& place : row.places) num_gaps += place.landmark_id == 0;
  }
  EXPECT_GT(num_gaps, 0);
  EXPECT_LE(num_gaps, static_cast<int>(b.missing.size()));
}

TEST(PlanNumbers, NamesThatAreNoNumbersAreCounted) {
  OrchardPlan plan;
  for (const char* name : {"east", "west"}) {
    PlannedRow row{name, {}};
    for (int k = 0; k < 6; ++k) {
      const double y_m = plan.rows.empty() ? 0.0 : 4.0 + 0.9 * k;
      row.trees.push_back({k == 2 ? "2b" : std::to_string(k + 1), {2.0 * k, y_m}});
    }
    plan.rows.push_back(row);
  }
  std::vector<Landmark> landmarks;
  for (const Eigen::Vector2d& p : plan.places()) {
    landmarks.push_back(test::tree(100 + static_cast<int>(landmarks.size()), p.x(), p.y()));
  }
  const PlanMatch match = match_plan(plan, landmarks, DetectionMap(), {});
  ASSERT_TRUE(match.is_registered()) << match.fit.reason;
  const PlanNames names = number_by_plan(plan, match, landmarks);
  EXPECT_EQ(landmarks[8].row, 2);
  EXPECT_EQ(landmarks[8].position, 3);
  EXPECT_EQ(names.at(108).row, "west");
  EXPECT_EQ(names.at(108).tree, "2b");
  const RowNames named{{1, "east"}, {2, "west"}};
  EXPECT_EQ(plan_row_names(landmarks, names), named);
}

TEST(PlanBuilding, TreesComeInOrderOfNumbersOrAlongTheRow) {
  const BuiltPlan built = plan_of_trees({{"A", "10", {20, 0}},
                                         {"A", "9", {22, 0}},
                                         {"B", "", {0, 5}},
                                         {"B", "", {4, 5}},
                                         {"B", "", {2, 5}}});
  EXPECT_TRUE(built.problems.empty());
  ASSERT_EQ(built.plan.rows.size(), 2u);
  EXPECT_EQ(built.plan.rows[0].trees[0].name, "9");
  EXPECT_EQ(built.plan.rows[1].trees[1].name, "2");
  EXPECT_DOUBLE_EQ(built.plan.rows[1].trees[1].p_plan.x(), 2.0);
}

TEST(PlanBuilding, RowsAreInOrderOfTheirNames) {
  std::vector<LoosePlannedTree> trees;
  std::vector<PlannedLine> lines;
  double y_m = 0.0;
  for (const char* name : {"A10-Sur", "A2-Sur", "A-Sur", "A2-Norte", "12", "3"}) {
    trees.push_back({name, "1", {0.0, y_m}});
    lines.push_back({name, {{0.0, y_m}, {4.0, y_m}}});
    y_m += 4.0;
  }
  for (const BuiltPlan& built : {plan_of_trees(trees), plan_of_lines(lines, 2.0)}) {
    std::string names;
    for (const PlannedRow& row : built.plan.rows) names += row.name + " ";
    EXPECT_EQ(names, "3 12 A-Sur A2-Norte A2-Sur A10-Sur ");
  }
}

TEST(PlanBuilding, SaysWhatCannotBe) {
  const auto problems_of = [](const std::vector<LoosePlannedTree>& trees) {
    std::string all;
    for (const std::string& p : plan_of_trees(trees).problems) all += p + "\n";
    return all;
  };
  EXPECT_EQ(problems_of({{"1", "1", {0, 0}}, {"1", "1", {2, 0}}}), "row 1 has two trees 1\n");
  EXPECT_EQ(problems_of({{"1", "1", {0, 0}}, {"2", "4", {0.05, 0}}}),
            "trees 1/1 and 2/4 have the same position\n");
  EXPECT_EQ(problems_of({{"1", "1", {0, 0}}, {"", "4", {3, 0}}}), "1 of 2 trees have no row\n");
}

TEST(PlanBuilding, LinesCarryTreesAtEqualSteps) {
  const BuiltPlan built = plan_of_lines({{"", {{0, 0}, {6, 0}, {6, 6}}}}, 4.0);
  ASSERT_TRUE(built.problems.empty());
  const auto places = built.plan.places();
  ASSERT_EQ(places.size(), 4u);  // at 0, 4, 8 and 12 m of 12
  EXPECT_TRUE(places[2].isApprox(Eigen::Vector2d(6, 2)));
  EXPECT_TRUE(places[3].isApprox(Eigen::Vector2d(6, 6)));
}

TEST(PlanBuilding, FindsRowsThatAreNotNamed) {
  std::vector<LoosePlannedTree> trees;
  for (int r = 0; r < 5; ++r) {
    for (int k = 0; k < 12; ++k) trees.push_back({"", "", {2.0 * k, 4.0 * r}});
  }
  const BuiltPlan built = plan_of_trees(trees);
  EXPECT_TRUE(built.problems.empty());
  EXPECT_EQ(built.plan.rows.size(), 5u);
  EXPECT_EQ(built.plan.num_trees(), 60u);
  ASSERT_EQ(built.notes.size(), 1u);
}

}  // namespace
}  // namespace orchard::mapping
