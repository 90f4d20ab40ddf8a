// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_comparison.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "unit/mapping/compare/two_drives.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

MapComparison compare(const DrivenMap& a, const DrivenMap& b, ComparisonConfig config = {}) {
  const DetectionMap view_a = view_of(a), view_b = view_of(b);
  const MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, view_a, view_b, MapAlignmentConfig{});
  EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << alignment.reason;
  return compare_maps(a.landmarks, b.landmarks, view_a, view_b, alignment, config);
}

/// The tree of the block that a change speaks of.
std::size_t tree_of(const MapChange& c, const DrivenMap& a, const DrivenMap& b) {
  return static_cast<std::size_t>(c.a >= 0 ? a.tree_of[static_cast<std::size_t>(c.a)]
                                           : b.tree_of[static_cast<std::size_t>(c.b)]);
}

struct Score {
  int right = 0, wrong = 0, overlooked = 0;
};

// What may be the ground is in one map and not in the other as the robot sways.
TEST(MapComparison, WhatIsUnseenAndSurelyNoTreeIsNoChange) {
  Dice dice(4);
  Block block = plant_block(dice, 6, 12, 0.0);
  const DrivenMap a = drive_through(block, Drive{}, dice);
  for (const double probability : {0.05, 0.5}) {
    DrivenMap b = a;
    Landmark tuft = b.landmarks[b.landmarks.size() / 2];
    tuft.id = 9000;
    tuft.label = detection::Label::kUnseen;
    tuft.probability = probability;
    tuft.x_m += 1.0;
    b.landmarks.push_back(tuft);
    const std::vector<MapChange> changes = compare(a, b).changes;
    const auto num = std::count_if(changes.begin(), changes.end(),
                                   [](const MapChange& c) { return c.change == Change::kNew; });
    EXPECT_EQ(num, probability < 0.1 ? 0 : 1) << probability;
  }
}

TEST(MapComparison, FindsFivePercentOfChange) {
  Score score;
  for (int seed = 1; seed <= 5; ++seed) {
    Dice dice(static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 10, 30);
    const DrivenMap a = drive_through(block, Drive{}, dice);
    std::map<std::size_t, Change> truth;
    for (std::size_t i = 0; i < block.trees.size(); ++i) {
      TrueTree& t = block.trees[i];
      const double die = dice.uniform(0, 1);
      if (!t.stands) {
        if (die < 0.25) {  // replanted in a gap
          t.stands = true;
          truth[i] = Change::kNew;
        }
      } else if (die < 0.03) {
        t.stands = false;
        truth[i] = Change::kMissing;
      } else if (die < 0.04) {
        t.width_m += 0.06;
        truth[i] = Change::kGrown;
      } else if (die < 0.05) {
        t.p += Vector2d(0.35, -0.25);
        truth[i] = Change::kMoved;
      }
    }
    Drive later;
    later.T_map_block = {1.5, -0.8, 0.02};
    const DrivenMap b = drive_through(block, later, dice);
    int right = 0;
    for (const MapChange& c : compare(a, b).changes) {
      if (c.change == Change::kUnchanged || c.change == Change::kNotSeen) continue;
      const auto found = truth.find(tree_of(c, a, b));
      const bool is_right = found != truth.end() && found->second == c.change;
      right += is_right;
      score.wrong += !is_right;
    }
    score.right += right;
    score.overlooked += static_cast<int>(truth.size()) - right;
  }
  const double precision = static_cast<double>(score.right) / (score.right + score.wrong);
  const double recall = static_cast<double>(score.right) / (score.right + score.overlooked);
  EXPECT_GE(precision, 0.95) << score.wrong << " wrong";
  EXPECT_GE(recall, 0.95) << score.overlooked << " overlooked of "
                          << score.right + score.overlooked;
  EXPECT_GT(score.right, 70);
}

TEST(MapComparison, TwoDrivesOfOneBlockDifferInNothing) {
  int num_changes = 0, num_trees = 0;
  for (int seed = 11; seed <= 14; ++seed) {
    Dice dice(static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 10, 30);
    Drive poor;
    poor.rate = 0.08;  // some trees are missed by chance
    const DrivenMap a = drive_through(block, Drive{}, dice);
    const DrivenMap b = drive_through(block, seed % 2 == 0 ? poor : Drive{}, dice);
    const MapComparison comparison = compare(a, b);
    for (const MapChange& c : comparison.changes) {
      num_changes += c.change != Change::kUnchanged && c.change != Change::kNotSeen;
      ++num_trees;
    }
    EXPECT_NEAR(comparison.width_change_common_m, 0.0, 0.003);
  }
  EXPECT_LE(num_changes, num_trees / 100) << "of " << num_trees;
}

TEST(MapComparison, WhatWasNotLookedAtIsNotMissing) {
  Dice dice(21);
  Block block = plant_block(dice, 10, 30);
  Drive whole, half;
  half.last_aisle = 4;  // sees rows 0 to 4 only
  const DrivenMap a = drive_through(block, whole, dice);
  const DrivenMap b = drive_through(block, half, dice);
  const MapComparison comparison = compare(a, b);
  EXPECT_LE(comparison.count(Change::kMissing), 1);
  EXPECT_GT(comparison.count(Change::kNotSeen), 100);
  // and backwards: what only the whole drive saw is not new
  EXPECT_LE(compare(b, a).count(Change::kNew), 1);
  ComparisonConfig trusting;
  trusting.assume_seen = true;
  EXPECT_GT(compare(a, b, trusting).count(Change::kMissing), 100);
}

TEST(MapComparison, MovedIsWhatIsAsWideAndReplacedWhatIsNot) {
  Dice dice(61);
  Block block = plant_block(dice, 6, 15);
  Drive drive = whole_drive(6, 15);
  const DrivenMap a = drive_through(block, drive, dice);
  const auto far_from_gaps = [&](std::size_t i) {
    return block.trees[i - 1].stands && block.trees[i].stands && block.trees[i + 1].stands;
  };
  std::size_t moved = 20, replaced = 50;
  while (!far_from_gaps(moved)) ++moved;
  while (!far_from_gaps(replaced)) ++replaced;
  block.trees[moved].p.x() += 1.3;
  block.trees[replaced].p.x() += 1.3;
  block.trees[replaced].width_m += 0.08;
  const DrivenMap b = drive_through(block, drive, dice);
  const MapComparison comparison = compare(a, b);
  EXPECT_EQ(comparison.count(Change::kMoved), 1);
  EXPECT_EQ(comparison.count(Change::kMissing), 1);
  EXPECT_EQ(comparison.count(Change::kNew), 1);
  for (const MapChange& c : comparison.changes) {
    if (c.change == Change::kUnchanged) continue;
    EXPECT_EQ(tree_of(c, a, b), c.change == Change::kMoved ? moved : replaced);
    if (c.change == Change::kMoved) {
      EXPECT_NEAR(c.moved_m, 1.3, 0.2);
    }
  }
}

TEST(MapComparison, ATrunkThatGrewBeyondTheClassOfTreesHasGrown) {
  Dice dice(62);
  Block block = plant_block(dice, 6, 15);
  Drive drive = whole_drive(6, 15);
  drive.position_sd_m = 0.005;
  drive.width_sd_m = 0.002;
  drive.bend_m = 0.0;
  const DrivenMap a = drive_through(block, drive, dice);
  DrivenMap b = drive_through(block, drive, dice);
  Landmark &grown = b.landmarks[30], &other = b.landmarks[40];
  grown.width_m += 0.04;
  grown.label = detection::Label::kObject;  // a laser alone judges by width
  other.width_m += 0.3;                     // something else stands before it now
  other.x_m += 0.1;
  other.label = detection::Label::kObject;
  const MapComparison comparison = compare(a, b);
  ASSERT_EQ(comparison.count(Change::kGrown), 1);
  for (const MapChange& c : comparison.changes) {
    if (c.change != Change::kGrown) continue;
    EXPECT_EQ(c.b, 30);
    EXPECT_GE(c.confidence, 0.8);
  }
}

TEST(MapComparison, GrowthIsClaimedAsFarAsTheWidthsAreKnown) {
  for (const double sd_m : {0.0005, 0.004}) {
    Dice dice(63);
    Block block = plant_block(dice, 6, 15);
    Drive drive = whole_drive(6, 15);
    drive.width_sd_m = sd_m;
    DrivenMap a = drive_through(block, drive, dice);
    for (std::size_t i = 0; i < block.trees.size(); i += 3) block.trees[i].width_m += 0.005;
    DrivenMap b = drive_through(block, drive, dice);
    for (DrivenMap* map : {&a, &b}) {
      for (Landmark& l : map->landmarks) l.width_sd_m = sd_m;
    }
    int num_grown = 0, num_found = 0, num_false = 0;
    for (const MapChange& c : compare(a, b).changes) {
      const bool has_grown = tree_of(c, a, b) % 3 == 0;
      num_grown += has_grown;
      num_found += has_grown && c.change == Change::kGrown;
      num_false += !has_grown && c.change == Change::kGrown;
    }
    ASSERT_GT(num_grown, 15);
    EXPECT_EQ(num_false, 0) << sd_m;
    if (sd_m < 0.001) {
      EXPECT_GE(num_found, 0.95 * num_grown);  // 5 mm are seven standard deviations of a difference
    } else {
      EXPECT_EQ(num_found, 0);  // less than one
    }
  }
}

TEST(MapComparison, CommonGrowthIsThatOfTheTreesWhateverPostsAndBushesDo) {
  for (const double growth_m : {0.0094, 0.02}) {
    Dice dice(71);
    Block block = plant_block(dice, 6, 15);
    Drive drive = whole_drive(6, 15);
    drive.width_sd_m = 0.001;
    DrivenMap a = drive_through(block, drive, dice);
    for (TrueTree& tree : block.trees) tree.width_m += growth_m;
    DrivenMap b = drive_through(block, drive, dice);
    const std::size_t num_trees = std::min(a.landmarks.size(), b.landmarks.size());
    // Between the trees of each row stand posts, which do not grow, and bushes, whose width depends
    // on the side from which they are seen.
    for (int i = 0; i < 6 * 28; ++i) {
      const bool is_bush = i % 4 == 0;
      const int place = i % 28;
      const int column = place / 2, row = i / 28;
      const Vector2d p(2.0 * column + (place % 2 == 0 ? 0.7 : 1.3), 4.0 * row);
      for (DrivenMap* map : {&a, &b}) {
        Landmark l = map->landmarks[10];
        l.id = 1000 + i;
        l.label = detection::Label::kObject;
        l.x_m = p.x() + dice.normal(0.01);
        l.y_m = p.y() + dice.normal(0.01);
        l.width_m = is_bush ? dice.uniform(0.1, 0.3) : 0.08 + dice.normal(0.001);
        map->landmarks.push_back(l);
        map->tree_of.push_back(-1);
      }
    }
    const MapComparison comparison = compare(a, b);
    // the median of 80 differences of widths, each with a standard deviation of 1.4 mm
    EXPECT_NEAR(comparison.width_change_common_m, growth_m, 0.001);
    EXPECT_LT(comparison.width_change_common_se_m, 0.0005);
    EXPECT_GT(comparison.count(Change::kGrown), static_cast<int>(0.9 * num_trees));
  }
}

TEST(MapComparison, OneThingThatIsTwoLandmarksIsNoChange) {
  Dice dice(31);
  Block block = plant_block(dice, 6, 15);
  Drive drive = whole_drive(6, 15);
  DrivenMap a = drive_through(block, drive, dice);
  const DrivenMap b = drive_through(block, drive, dice);
  Landmark echo = a.landmarks[20];
  echo.id = 900;
  echo.x_m += 0.12;
  a.landmarks.push_back(echo);
  a.tree_of.push_back(a.tree_of[20]);
  EXPECT_EQ(compare(a, b).count(Change::kMissing), 0);
  EXPECT_EQ(compare(b, a).count(Change::kNew), 0);
  // a class that changed is no change of the tree, nor is the width that an object is given
  DrivenMap relabelled = b;
  relabelled.landmarks[10].label = detection::Label::kObject;
  relabelled.landmarks[10].width_m += 0.2;
  const MapComparison comparison = compare(a, relabelled);
  EXPECT_EQ(comparison.count(Change::kMissing) + comparison.count(Change::kGrown), 0);
}

TEST(MapComparison, ABushIsNotTheTreesThatItsPartsPassFor) {
  Dice dice(41);
  Block block = plant_block(dice, 6, 15);
  Drive drive = whole_drive(6, 15);
  DrivenMap a = drive_through(block, drive, dice);
  DrivenMap b = drive_through(block, drive, dice);
  // halfway between trees; each drive sees parts of its own, one or two of them thick as a trunk
  const auto add_bush = [&](DrivenMap& map, const Vector2d& p, int id) {
    for (int part = 0; part < 5; ++part) {
      Landmark l = map.landmarks[10];
      l.id = id + part;
      l.x_m = p.x() + dice.uniform(-0.3, 0.3);
      l.y_m = p.y() + dice.uniform(-0.3, 0.3);
      l.width_m = part < 2 ? dice.uniform(0.09, 0.15) : dice.uniform(0.06, 0.5);
      l.label = part < 2 ? detection::Label::kTree : detection::Label::kObject;
      map.landmarks.push_back(l);
      map.tree_of.push_back(-1);
    }
  };
  for (int bush = 0; bush < 8; ++bush) {
    const int row = bush / 4 + 1;
    const Vector2d p(3.0 + 4.0 * (bush % 4), 4.0 * row);
    add_bush(a, p, 1000 + 10 * bush);
    add_bush(b, p, 2000 + 10 * bush);
  }
  add_bush(b, {25.0, 12.0}, 3000);  // and one is truly new
  const MapComparison comparison = compare(a, b);
  int num_false = 0, num_of_new = 0;
  for (const MapChange& c : comparison.changes) {
    if (c.change == Change::kUnchanged || c.change == Change::kNotSeen) continue;
    ((c.p_a - Vector2d(25.0, 12.0)).norm() < 0.6 ? num_of_new : num_false)++;
  }
  EXPECT_EQ(num_false, 0);
  EXPECT_EQ(num_of_new, 2) << "its parts that pass for trees";
}

TEST(MapComparison, SuckersThatOneVisitSeesAreNoChange) {
  Dice dice(51);
  Block block = plant_block(dice, 6, 15);
  Drive drive = whole_drive(6, 15);
  DrivenMap a = drive_through(block, drive, dice);
  DrivenMap b = drive_through(block, drive, dice);
  for (DrivenMap* map : {&a, &b}) {
    for (int i = 0; i < 12; ++i) {  // each visit has its own, seen at a tenth of their chances
      const Landmark& tree = map->landmarks[static_cast<std::size_t>(5 * i + 3)];
      Landmark l = tree;
      l.id = 1000 + i;
      l.x_m += map == &a ? 0.9 : -0.9;
      l.width_m = 0.06;
      l.num_observations = 12;
      map->landmarks.push_back(l);
      map->tree_of.push_back(-1);
    }
  }
  for (const MapComparison& comparison : {compare(a, b), compare(b, a)}) {
    EXPECT_EQ(comparison.count(Change::kMissing), 0);
    EXPECT_EQ(comparison.count(Change::kNew), 0);
    EXPECT_EQ(comparison.count(Change::kMoved), 0);
  }
}

TEST(MapComparison, AStumpThatEachVisitCutsAnewIsNoChange) {
  Dice dice(52);
  Block block = plant_block(dice, 6, 15);
  Drive drive = whole_drive(6, 15);
  DrivenMap a = drive_through(block, drive, dice);
  DrivenMap b = drive_through(block, drive, dice);
  // one landmark, whose observations scatter by 0.48 m, or four
  Landmark whole = a.landmarks[20];
  whole.id = 900;
  whole.y_m += 1.6;
  whole.num_observations = 144;
  whole.se_x_m = whole.se_y_m = 0.04;
  a.landmarks.push_back(whole);
  a.tree_of.push_back(-1);
  const Vector2d offsets[] = {{0.1, 0.5}, {-0.6, -0.1}, {0.5, -0.4}, {-0.1, -0.9}};
  for (int part = 0; part < 4; ++part) {
    Landmark l = whole;
    l.id = 901 + part;
    l.x_m += offsets[part].x();
    l.y_m += offsets[part].y();
    l.num_observations = 36;
    l.se_x_m = l.se_y_m = 0.02;
    b.landmarks.push_back(l);
    b.tree_of.push_back(-1);
  }
  for (const MapComparison& comparison : {compare(a, b), compare(b, a)}) {
    EXPECT_EQ(comparison.count(Change::kMissing), 0);
    EXPECT_EQ(comparison.count(Change::kNew), 0);
    EXPECT_EQ(comparison.count(Change::kMoved), 0);
  }
}

TEST(DetectionMap, HiddenAndFarPlacesAreNotLookedAt) {
  std::vector<Landmark> landmarks;
  std::vector<pose::PoseEstimate> path;
  for (int i = 0; i < 80; ++i) {  // rows at y = 2 and y = -4, seen from y = 0 a hundred times each
    const double width_m = i == 20 ? 2.4 : 0.1;  // one is a wall
    landmarks.push_back(test::tree(i + 1, i % 40, i < 40 ? 2.0 : -4.0, width_m, 100));
  }
  for (int i = 0; i < 400; ++i) {
    pose::PoseEstimate p;
    p.utime = 100000 * (i + 1);
    p.x_m = 0.1 * i;
    path.push_back(p);
  }
  SensorView view;
  view.reach_m = 8.0;
  const DetectionMap seen(landmarks, {path}, view);
  const auto missed = seen.probability_missed_anywhere();
  const double expected = seen.expected_observations({{10.2, 2.0}}).front();
  EXPECT_NEAR(expected, 100.0, 35.0);
  EXPECT_LT(missed({10.5, 2.0}), 0.01);
  EXPECT_EQ(missed({10.5, 12.0}), 1.0) << "beyond reach";
  EXPECT_EQ(missed({10.5, -30.0}), 1.0);
  std::size_t num_seen = 0;  // cells in which a tree is rather mapped, by asking each of them
  for (double x_m = -79.75; x_m < 120.0; x_m += 0.5) {
    for (double y_m = -79.75; y_m < 80.0; y_m += 0.5) num_seen += missed({x_m, y_m}) < 0.5;
  }
  EXPECT_GT(num_seen, 100u);
  EXPECT_EQ(seen.places_seen().size(), num_seen);
  for (const Vector2d& p : seen.places_seen()) EXPECT_LT(missed(p), 0.5) << p.transpose();
  EXPECT_TRUE(DetectionMap().places_seen().empty());
  EXPECT_GT(seen.probability_mapped(expected, 0.9), 0.99);
  SensorView strict = view;  // a map without what was seen less than 90 times
  strict.min_observations = 90;
  EXPECT_LT(DetectionMap(landmarks, {path}, strict).probability_mapped(expected, 0.5), 0.5);
  const VisibilityGrid grid(landmarks, {path}, view);
  const auto seconds_near = [&](const Vector2d& p) {
    const VisibilityGrid::Seconds seconds = grid.at({p}).front();
    return seconds[0] + seconds[1] + seconds[2] + seconds[3];  // within 4.5 m
  };
  EXPECT_GT(seconds_near({8.4, 3.2}), 3.0);
  EXPECT_LT(seconds_near({20.2, 3.2}), 0.25 * seconds_near({8.4, 3.2})) << "behind the wall";
  // The two ways to look: at cells that are asked for, and at all.
  std::vector<Vector2d> everywhere;
  for (int k = 0; k < 3000; ++k) everywhere.push_back({-9.3 + 0.5 * (k % 100), -11.2 + k / 100});
  const std::vector<VisibilityGrid::Seconds> seconds = grid.at(everywhere);
  VisibilityGrid all = grid;
  VisibilityGrid::Weights per_second;
  for (std::size_t i = 0; i < per_second.size(); ++i) per_second[i] = 1.0 + i;
  all.weigh(per_second);
  for (std::size_t k = 0; k < everywhere.size(); ++k) {
    double sum = 0.0;
    for (std::size_t i = 0; i < per_second.size(); ++i) sum += seconds[k][i] * per_second[i];
    EXPECT_EQ(all.sum_at(everywhere[k]), sum) << everywhere[k].transpose();
  }
  SensorView left = view;  // a laser that looks to the right only sees no row to the left
  left.bearing_min_rad = -2.0;
  left.bearing_max_rad = -0.5;
  EXPECT_EQ(DetectionMap(landmarks, {path}, left).probability_missed_anywhere()({10.5, 2.0}), 1.0);
  EXPECT_EQ(DetectionMap().probability_missed_anywhere()({10.5, 2.0}), 1.0);
}

}  // namespace
}  // namespace orchard::mapping
