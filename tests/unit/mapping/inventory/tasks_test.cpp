// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/inventory/tasks.hpp"

#include <gtest/gtest.h>

#include "mapping/rows/row_numbers.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

/// Two rows of ten places 3 m apart, without some of the second row's.
struct Block {
  explicit Block(std::vector<int> empty, std::string block_day = "2026-10-18")
      : day(std::move(block_day)) {
    for (int row = 1; row <= 2; ++row) {
      for (int k = 1; k <= 10; ++k) {
        if (row == 2 && std::find(empty.begin(), empty.end(), k) != empty.end()) continue;
        landmarks.push_back(test::tree(10 * row + k, 3.0 * k, 5.0 * row, 0.12));
        landmarks.back().row = row;
        landmarks.back().position = k;
      }
    }
    rows = numbered_rows(landmarks);
  }
  TaskUpdate update(std::vector<Task> earlier) const {
    return update_tasks(std::move(earlier), {landmarks, rows, names, day}, nullptr);
  }
  std::vector<Landmark> landmarks;
  std::vector<Row> rows;
  RowNames names{{2, "north"}};
  std::string day;
};

TEST(Tasks, EachGapIsOneTaskWithItsPlace) {
  const TaskUpdate update = Block({4, 7}).update({});
  ASSERT_EQ(update.tasks.size(), 2u);
  EXPECT_EQ(update.num_new, 2);
  const Task& task = update.tasks[0];
  EXPECT_EQ(task.number, 1);
  EXPECT_FALSE(task.is_done);
  EXPECT_EQ(task.what, kPlantTask);
  EXPECT_EQ(task.row, "north");
  EXPECT_EQ(task.tree, 4);
  EXPECT_EQ(task.since, "2026-10-18");
  EXPECT_NEAR((task.p_map - Eigen::Vector2d(12.0, 10.0)).norm(), 0.0, 1e-9);
}

TEST(Tasks, WhatWasTickedStaysAndATreeClosesWhatWasOpen) {
  std::vector<Task> tasks = Block({4, 7}, "2026-05-04").update({}).tasks;
  tasks[0].is_done = true;
  tasks[0].note = "planted in June";
  tasks[0].p_map.x() += 0.3;  // fixes of another day
  const TaskUpdate update = Block({4}).update(tasks);
  ASSERT_EQ(update.tasks.size(), 2u);
  EXPECT_EQ(update.num_found, 1);
  EXPECT_EQ(update.num_seen, 1);
  EXPECT_TRUE(update.tasks[0].is_done);
  EXPECT_EQ(update.tasks[0].seen, "");
  EXPECT_EQ(update.tasks[0].note, "planted in June");
  EXPECT_EQ(update.tasks[0].since, "2026-05-04");
  EXPECT_NEAR(update.tasks[0].p_map.x(), 12.0, 1e-9);
  EXPECT_TRUE(update.tasks[1].is_done);
  EXPECT_EQ(update.tasks[1].seen, "2026-10-18");
}

TEST(Tasks, WhereTheTreeIsGoneAgainANewOneBegins) {
  std::vector<Task> tasks = Block({4}, "2026-05-04").update({}).tasks;
  tasks = Block({}, "2026-10-18").update(tasks).tasks;
  ASSERT_TRUE(tasks[0].is_done);
  const TaskUpdate update = Block({4}, "2027-05-02").update(tasks);
  ASSERT_EQ(update.tasks.size(), 2u);
  EXPECT_TRUE(update.tasks[0].is_done);
  EXPECT_EQ(update.tasks[1].number, 2);
  EXPECT_FALSE(update.tasks[1].is_done);
  EXPECT_EQ(update.tasks[1].since, "2027-05-02");
}

TEST(Tasks, ATreeBesideTheGapAndWhatIsElsewhereCloseNothing) {
  std::vector<Task> tasks = Block({4}).update({}).tasks;
  tasks.push_back(tasks[0]);
  tasks[1].number = 9;
  tasks[1].p_map = {500.0, 0.0};  // of another block
  tasks.push_back(tasks[0]);
  tasks[2].number = 0;
  tasks[2].what = "mend the wire";
  const TaskUpdate update = Block({4}).update(tasks);
  ASSERT_EQ(update.tasks.size(), 3u);
  for (const Task& task : update.tasks) EXPECT_FALSE(task.is_done) << task.number;
  EXPECT_EQ(update.num_found, 1);
  EXPECT_EQ(update.tasks[2].number, 10);
}

TEST(Tasks, ChangesGiveRiseToPlantingAndToALook) {
  const Block before({}, "2026-05-04");
  Block now({4, 10});  // 10 is the row's end, so no gap
  MapAlignment alignment;
  alignment.T_a_b = {100.0, 0.0, 0.0};  // the earlier map's origin lies 100 m west
  MapComparison comparison;
  const auto change = [&](Change kind, int a, int b, Eigen::Vector2d p_a) {
    MapChange& c = comparison.changes.emplace_back();
    c.change = kind;
    c.a = a;
    c.b = b;
    c.p_a = p_a;
    c.moved_m = 0.314;
  };
  change(Change::kMissing, 13, -1, {112.0, 10.0});
  change(Change::kMissing, 19, -1, {130.0, 10.0});
  change(Change::kMoved, 0, 0, {103.0, 5.0});
  const EarlierTrees earlier{before.landmarks, comparison, alignment, before.day};
  const TaskUpdate update =
      update_tasks({}, {now.landmarks, now.rows, now.names, now.day}, &earlier);
  ASSERT_EQ(update.tasks.size(), 3u);
  EXPECT_EQ(update.tasks[0].tree, 4);
  EXPECT_EQ(update.tasks[0].why, "missing since 2026-05-04");
  EXPECT_EQ(update.tasks[1].tree, 10);
  EXPECT_EQ(update.tasks[1].what, kPlantTask);
  EXPECT_NEAR((update.tasks[1].p_map - Eigen::Vector2d(30.0, 10.0)).norm(), 0.0, 1e-9);
  EXPECT_EQ(update.tasks[2].what, kCheckTask);
  EXPECT_EQ(update.tasks[2].why, "moved by 0.31 m");
  EXPECT_NEAR((update.tasks[2].p_map - Eigen::Vector2d(3.0, 5.0)).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace orchard::mapping
