// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_merging.hpp"

#include <gtest/gtest.h>
#include <cmath>

#include <algorithm>
#include <map>
#include <set>

#include "mapping/rows/row_numbers.hpp"
#include "unit/mapping/compare/two_drives.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;
using Eigen::Vector2d;

/// A landmark as the paper's statistics make it of single observations.
Landmark landmark_of(const std::vector<Vector2d>& observations, double roc) {
  Landmark l;
  l.id = 1;
  l.label = Label::kTree;
  const auto n = static_cast<double>(observations.size());
  Vector2d mean(0, 0), sum(0, 0);
  for (const Vector2d& p : observations) mean += p / n;
  for (const Vector2d& p : observations) sum += (p - mean).cwiseProduct(p - mean);
  l.num_observations = static_cast<int>(observations.size());
  l.x_m = mean.x();
  l.y_m = mean.y();
  l.se_x_m = std::sqrt(sum.x() / (n * (n - 1)));
  l.se_y_m = std::sqrt(sum.y() / (n * (n - 1)));
  l.roc_mean = roc;
  l.probability = 0.9;
  l.width_m = 0.1;
  return l;
}

MapAlignment aligned(const DrivenMap& a, const DrivenMap& b) {
  MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, DetectionMap(), DetectionMap(), MapAlignmentConfig{});
  EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << alignment.reason;
  return alignment;
}

TEST(Merging, StatisticsAreThoseOfAllObservationsTogether) {
  Dice dice(1);
  std::vector<Vector2d> first, second, all;
  for (int i = 0; i < 5; ++i) first.push_back({2.0 + dice.normal(0.03), 1.0 + dice.normal(0.02)});
  for (int i = 0; i < 9; ++i) second.push_back({2.05 + dice.normal(0.03), 1.0 + dice.normal(0.02)});
  all = first;
  all.insert(all.end(), second.begin(), second.end());
  const Landmark both = merged_landmark(landmark_of(first, 0.6), landmark_of(second, 0.9));
  const Landmark truth = landmark_of(all, 0.0);
  EXPECT_EQ(both.num_observations, 14);
  EXPECT_NEAR(both.se_x_m, truth.se_x_m, 1e-12);
  EXPECT_NEAR(both.se_y_m, truth.se_y_m, 1e-12);
  EXPECT_NEAR(both.roc_mean, (5 * 0.6 + 9 * 0.9) / 14, 1e-12);
  EXPECT_GT(both.probability, 0.98);
  EXPECT_EQ(both.id, 1);
}

TEST(Merging, TheBetterKnownPlaceWeighsMore) {
  Landmark a, b;
  a.num_observations = b.num_observations = 10;
  a.covariance = {0.0001, 0.0, 0.09};
  b.covariance = {0.09, 0.0, 0.0001};
  b.x_m = b.y_m = 1.0;
  const Landmark both = merged_landmark(a, b);
  EXPECT_LT(both.x_m, 0.01);
  EXPECT_GT(both.y_m, 0.99);
  EXPECT_GT(both.covariance[0], 0.0);
  const Landmark turned = transformed(a, {0, 0, 1.5707963267948966});
  EXPECT_NEAR(turned.covariance[0], 0.09, 1e-9);
  EXPECT_NEAR(turned.covariance[2], 0.0001, 1e-9);
}

TEST(Merging, HeightsAreWeightedWhereBothAreKnown) {
  Landmark a, b;
  a.z_m = 1.0, a.z_sd_m = 0.1;
  b.z_m = 2.0, b.z_sd_m = 0.2;
  EXPECT_NEAR(merged_landmark(a, b).z_m, 1.2, 1e-12);  // four to one
  EXPECT_NEAR(merged_landmark(a, b).z_sd_m, 0.2 / std::sqrt(5.0), 1e-12);
  EXPECT_EQ(raised({a}, 2.5)[0].z_m, 3.5);
  EXPECT_EQ(raised({a}, std::nullopt)[0].z_sd_m, 0.0);
  const Landmark unknown;
  EXPECT_EQ(raised({unknown}, 2.5)[0].z_m, 0.0);
  for (const Landmark& l : {merged_landmark(a, unknown), merged_landmark(unknown, a)}) {
    EXPECT_EQ(l.z_m, 1.0);
    EXPECT_EQ(l.z_sd_m, 0.1);
  }
}

TEST(Merging, AnUnknownWidthTakesThatOfATrunkButNotThatOfFoliage) {
  Landmark hidden, trunk, foliage;
  hidden.label = trunk.label = Label::kTree;
  foliage.label = Label::kObject;
  hidden.probability = trunk.probability = 0.97;
  foliage.probability = 0.2;
  trunk.width_m = 0.1, trunk.width_sd_m = 0.01;
  foliage.width_m = 0.8, foliage.width_sd_m = 0.1;
  for (const Landmark& l : {merged_landmark(hidden, trunk), merged_landmark(trunk, hidden)}) {
    EXPECT_EQ(l.width_m, 0.1);
    EXPECT_EQ(l.width_sd_m, 0.01);
  }
  for (const Landmark& l : {merged_landmark(hidden, foliage), merged_landmark(foliage, hidden)}) {
    EXPECT_EQ(l.label, Label::kTree);
    EXPECT_EQ(l.width_m, 0.0);
    EXPECT_EQ(l.width_sd_m, 0.0);
  }
  hidden.probability = 0.6;
  EXPECT_EQ(merged_landmark(hidden, foliage).label, Label::kObject);
  EXPECT_EQ(merged_landmark(hidden, foliage).width_m, 0.8);
}

TEST(Merging, OneClassAgainstTheOther) {
  Landmark tree, object, unseen;
  tree.label = Label::kTree;
  tree.probability = 0.7;
  object.label = Label::kObject;
  object.probability = 0.05;
  unseen.probability = 0.5;
  tree.num_observations = object.num_observations = unseen.num_observations = 3;
  EXPECT_EQ(merged_landmark(tree, object).label, Label::kObject);
  EXPECT_EQ(merged_landmark(tree, unseen).label, Label::kTree);
  EXPECT_EQ(merged_landmark(unseen, object).label, Label::kObject);
  EXPECT_NEAR(merged_landmark(unseen, object).probability, 0.05, 1e-12);
}

TEST(Merging, TwoHalvesBecomeTheWholeBlock) {
  Dice dice(2);
  Block block = plant_block(dice, 10, 30);
  Drive left, right;
  left.last_aisle = 6;
  right.first_aisle = 4;
  right.T_map_block = {2.0, -1.0, 0.03};
  const DrivenMap a = drive_through(block, left, dice, 100);
  const DrivenMap b = drive_through(block, right, dice, 50);
  MergedMap merged{a.landmarks, 500};
  const std::vector<MergedId> ids = merge_into(merged, b.landmarks, aligned(a, b));
  std::set<int> all_trees(a.tree_of.begin(), a.tree_of.end());
  all_trees.insert(b.tree_of.begin(), b.tree_of.end());
  EXPECT_EQ(merged.landmarks.size(), all_trees.size()) << "every tree once";
  std::set<std::int32_t> unique;
  for (const Landmark& l : merged.landmarks) unique.insert(l.id);
  EXPECT_EQ(unique.size(), merged.landmarks.size());
  std::map<int, std::int32_t> id_of_tree;
  for (std::size_t i = 0; i < a.landmarks.size(); ++i) id_of_tree[a.tree_of[i]] = a.landmarks[i].id;
  int num_new = 0;
  for (std::size_t j = 0; j < b.landmarks.size(); ++j) {
    EXPECT_EQ(ids[j].before, b.landmarks[j].id);
    const auto known = id_of_tree.find(b.tree_of[j]);
    if (known != id_of_tree.end()) {
      EXPECT_EQ(ids[j].now, known->second);
    } else {
      EXPECT_GE(ids[j].now, 500) << "ids of earlier maps are not used again";
      ++num_new;
    }
  }
  EXPECT_GT(num_new, 80);
  EXPECT_EQ(merged.next_id, 500 + num_new);
}

struct Numbers {
  std::map<int, std::pair<int, int>> of_tree;  ///< index into the block -> row, position
  std::map<int, std::int32_t> id_of_tree;
};

Numbers numbers_of(const std::vector<Landmark>& landmarks,
                   const std::map<std::int32_t, int>& tree) {
  Numbers numbers;
  for (const Landmark& l : landmarks) {
    numbers.of_tree[tree.at(l.id)] = {l.row, l.position};
    numbers.id_of_tree[tree.at(l.id)] = l.id;
  }
  return numbers;
}

TEST(NumberKeeping, IdsAndNumbersSurviveFivePercentOfChange) {
  for (int seed = 1; seed <= 4; ++seed) {
    Dice dice(10 + static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 8, 25);
    Drive drive = whole_drive(8, 25);
    DrivenMap a = drive_through(block, drive, dice);
    std::vector<Row> rows = find_rows(a.landmarks, RowsConfig{});
    number_landmarks(rows, a.landmarks);
    for (TrueTree& t : block.trees) {
      if (dice.uniform(0, 1) < 0.05) t.stands = !t.stands;
      // the first tree of each row goes: find_rows() alone may count from the second
      if (t.place == 0 && t.row % 2 == 0) t.stands = false;
    }
    drive.T_map_block = {-1.0, 0.5, seed == 4 ? -0.05 : 0.01};
    DrivenMap b = drive_through(block, drive, dice);
    const MapAlignment alignment = aligned(a, b);
    std::map<std::int32_t, int> tree_a, tree_b;
    for (std::size_t i = 0; i < a.landmarks.size(); ++i) tree_a[a.landmarks[i].id] = a.tree_of[i];
    std::map<std::pair<double, double>, int> tree_at;
    for (std::size_t i = 0; i < b.landmarks.size(); ++i) {
      tree_at[{b.landmarks[i].x_m, b.landmarks[i].y_m}] = b.tree_of[i];
    }
    std::int32_t next_id = 1000;
    IdTransfer kept = keep_ids(a.landmarks, alignment, next_id, b.landmarks);
    rows = find_rows(b.landmarks, RowsConfig{});
    keep_numbers(a.landmarks, rows, b.landmarks, kept);
    for (const Landmark& l : b.landmarks) tree_b[l.id] = tree_at.at({l.x_m, l.y_m});
    const Numbers then = numbers_of(a.landmarks, tree_a), now = numbers_of(b.landmarks, tree_b);
    int num_same = 0, num_new = 0;
    std::set<std::pair<int, int>> given;
    for (const auto& [tree, number] : now.of_tree) {
      if (number.second != 0) {
        EXPECT_TRUE(given.insert(number).second) << number.first << "/" << number.second;
      }
      const auto before = then.of_tree.find(tree);
      if (before != then.of_tree.end()) {
        EXPECT_EQ(number, before->second);
        EXPECT_EQ(now.id_of_tree.at(tree), then.id_of_tree.at(tree));
        ++num_same;
      } else {
        EXPECT_GE(now.id_of_tree.at(tree), 1000);
        ++num_new;
      }
    }
    EXPECT_EQ(kept.num_found, num_same);
    EXPECT_EQ(kept.num_new, num_new);
    EXPECT_GT(num_same, 150);
  }
}

TEST(NumberKeeping, ATreeDoesNotTakeTheIdOfTheFelledOneBesideWhichItStandsNow) {
  Dice dice(30);
  Block block = plant_block(dice, 4, 15, 0.0);
  Drive drive = whole_drive(4, 15);
  const DrivenMap a = drive_through(block, drive, dice);
  const std::size_t moved = 20, felled = 21;
  block.trees[moved].width_m = 0.11;  // as it was mapped, nearly
  block.trees[felled].stands = false;
  const std::int32_t felled_id = a.landmarks[felled].id;
  DrivenMap known = a;
  known.landmarks[moved].width_m = 0.11;
  known.landmarks[felled].width_m = 0.17;
  block.trees[moved].p.x() += 1.55;
  DrivenMap b = drive_through(block, drive, dice);
  const Vector2d there(b.landmarks[moved].x_m, b.landmarks[moved].y_m);
  const MapAlignment alignment = aligned(known, b);
  std::int32_t next_id = 1000;
  keep_ids(known.landmarks, alignment, next_id, b.landmarks);
  for (const Landmark& l : b.landmarks) {
    EXPECT_NE(l.id, felled_id) << "an id is not given twice";
    if ((Vector2d(l.x_m, l.y_m) - there).norm() < 1e-9) {
      EXPECT_GE(l.id, 1000);
    }
  }
}

/// One row of trees two metres apart, numbered by hand.
std::vector<Landmark> row_of(const std::vector<std::pair<double, int>>& x_and_position) {
  std::vector<Landmark> row;
  for (const auto& [x_m, position] : x_and_position) {
    Landmark l = test::tree(static_cast<std::int32_t>(row.size()) + 1, x_m, 0.0, 0.1, 9);
    l.row = position == 0 ? 0 : 4;
    l.position = position;
    row.push_back(l);
  }
  return row;
}

TEST(NumberKeeping, NewTreesTakeThePlaceTheyStandAt) {
  // numbers 11 to 18, with 14 missing
  const std::vector<Landmark> earlier =
      row_of({{0, 11}, {2, 12}, {4, 13}, {8, 15}, {10, 16}, {12, 17}, {14, 18}});
  // 12 has gone; one stands at 14's place, one beyond the end, one squeezed between 16 and 17
  std::vector<Landmark> now =
      row_of({{0, 0}, {4, 0}, {6, 0}, {8, 0}, {10, 0}, {11, 0}, {12, 0}, {14, 0}, {16, 0}});
  const std::vector<std::int32_t> ids{1, 3, 20, 4, 5, 21, 6, 7, 22};
  Row row;
  row.number = 1;
  const std::vector<int> positions{1, 3, 4, 5, 6, 7, 8, 9, 10};
  for (std::size_t i = 0; i < now.size(); ++i) {
    now[i].id = ids[i];
    if (i == 1) row.places.push_back({2, 0, {2.0, 0.0}});
    row.places.push_back({positions[i], ids[i], {now[i].x_m, 0.0}});
  }
  IdTransfer kept;
  keep_numbers(earlier, {row}, now, kept);
  const std::vector<int> wanted{11, 13, 14, 15, 16, 0, 17, 18, 19};
  for (std::size_t i = 0; i < now.size(); ++i) {
    EXPECT_EQ(now[i].row, 4);
    EXPECT_EQ(now[i].position, wanted[i]) << i;
  }
  EXPECT_EQ(kept.num_without_number, 1);
  const std::vector<Row> rows = numbered_rows(now);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].number, 4);
  EXPECT_EQ(rows[0].places[1].landmark_id, 0) << "the gap is still there";
  EXPECT_EQ(rows[0].places[1].position, 12);
  // counted from the other end, nothing else changes
  std::reverse(row.places.begin(), row.places.end());
  for (std::size_t i = 0; i < row.places.size(); ++i) {
    row.places[i].position = static_cast<std::int32_t>(i) + 1;
  }
  std::vector<Landmark> again = now;
  keep_numbers(earlier, {row}, again, kept);
  for (std::size_t i = 0; i < now.size(); ++i) EXPECT_EQ(again[i].position, wanted[i]) << i;
}

}  // namespace
}  // namespace orchard::mapping
