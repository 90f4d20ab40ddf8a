// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/hidden_trees.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "mapping/rows/rows.hpp"
#include "planted_rows.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;

constexpr int kBlocks = 40;
constexpr double kTrunk_m = 0.12, kFoliage_m = 0.5, kPost_m = 0.06;
constexpr int kFirstBush = 100'000;  ///< ids of bushes; those of planted trees are lower

double uniform(std::mt19937_64& random, double a, double b) {
  return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A block of trees without posts, each as wide as a trunk.
test::Planted planted(std::mt19937_64& random) {
  test::Plan plan = test::random_plan(random);
  plan.post_fraction = 0.0;
  test::Planted block = test::plant(plan, random);
  for (Landmark& l : block.landmarks) l.width_m = kTrunk_m * uniform(random, 0.8, 1.2);
  return block;
}

/// As many bushes as `per_tree` of the trees, anywhere among them.
void add_bushes(std::mt19937_64& random, double per_tree, std::vector<Landmark>& landmarks) {
  double x_min_m = 1e9, x_max_m = -1e9, y_min_m = 1e9, y_max_m = -1e9;
  for (const Landmark& l : landmarks) {
    x_min_m = std::min(x_min_m, l.x_m);
    x_max_m = std::max(x_max_m, l.x_m);
    y_min_m = std::min(y_min_m, l.y_m);
    y_max_m = std::max(y_max_m, l.y_m);
  }
  const auto num = static_cast<int>(per_tree * static_cast<double>(landmarks.size()));
  for (int k = 0; k < num; ++k) {
    Landmark bush;
    bush.id = kFirstBush + k;
    bush.label = Label::kObject;
    bush.width_m = kFoliage_m;
    bush.x_m = uniform(random, x_min_m, x_max_m);
    bush.y_m = uniform(random, y_min_m, y_max_m);
    landmarks.push_back(bush);
  }
}

/// Turns every `step`-th tree into an object of this width; returns their ids.
std::set<std::int32_t> hide(int step, double width_m, std::vector<Landmark>& landmarks) {
  std::set<std::int32_t> hidden;
  for (Landmark& l : landmarks) {
    if (l.id % step != 0) continue;
    l.label = Label::kObject;
    l.width_m = width_m;
    hidden.insert(l.id);
  }
  return hidden;
}

/// The landmarks with the numbers of their rows, and trees named in the gaps.
std::vector<Landmark> named(std::vector<Landmark> landmarks) {
  number_landmarks(find_rows(landmarks, {}), landmarks);
  name_trees_in_gaps(landmarks);
  return landmarks;
}

std::size_t num_named(const std::vector<Landmark>& landmarks, const std::set<std::int32_t>& ids) {
  return static_cast<std::size_t>(
      std::count_if(landmarks.begin(), landmarks.end(), [&](const Landmark& l) {
        return l.label == Label::kTree && l.row > 0 && l.position > 0 && ids.count(l.id) > 0;
      }));
}

std::size_t num_bushes_named(const std::vector<Landmark>& landmarks) {
  return static_cast<std::size_t>(std::count_if(
      landmarks.begin(), landmarks.end(),
      [](const Landmark& l) { return l.label == Label::kTree && l.id >= kFirstBush; }));
}

TEST(HiddenTrees, FoliageInTheSlotsOfRowsIsTheirTreesAndBushesBesideThemAreNot) {
  std::mt19937_64 random(1);
  std::size_t num_hidden = 0, num_found = 0, num_wrong = 0;
  for (int k = 0; k < kBlocks; ++k) {
    std::vector<Landmark> landmarks = planted(random).landmarks;
    const std::set<std::int32_t> hidden = hide(9, kFoliage_m, landmarks);
    add_bushes(random, 0.3, landmarks);
    const std::vector<Landmark> after = named(landmarks);
    num_hidden += hidden.size();
    num_found += num_named(after, hidden);
    num_wrong += num_bushes_named(after);
  }
  // The first and last tree of a row stand in no gap.
  EXPECT_GE(num_found, num_hidden * 8 / 10) << num_hidden;
  EXPECT_LE(num_wrong, (num_found + num_wrong) / 10);
}

TEST(HiddenTrees, WhereNoneAreHiddenBushesInGapsAreRarelyTaken) {
  std::mt19937_64 random(2);
  std::size_t num_wrong = 0;
  for (int k = 0; k < kBlocks; ++k) {
    std::vector<Landmark> landmarks = planted(random).landmarks;
    add_bushes(random, 0.5, landmarks);
    num_wrong += num_bushes_named(named(landmarks));
  }
  EXPECT_LE(num_wrong, kBlocks / 4);
}

TEST(HiddenTrees, PostsAndHedgesInGapsHideNoTrunk) {
  std::mt19937_64 random(3);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    std::vector<Landmark> posts = planted(random).landmarks;
    std::vector<Landmark> hedges = posts;
    const std::set<std::int32_t> thin = hide(9, kPost_m, posts);
    EXPECT_EQ(num_named(named(posts), thin), 0u);
    const std::set<std::int32_t> pieces = hide(9, kFoliage_m, hedges);
    for (Landmark& l : hedges) l.length_m = pieces.count(l.id) > 0 ? 1.5 : 0.0;
    EXPECT_EQ(num_named(named(hedges), pieces), 0u);
  }
}

TEST(HiddenTrees, OrderOfLandmarksDoesNotMatter) {
  std::mt19937_64 random(4);
  for (int k = 0; k < 5; ++k) {
    std::vector<Landmark> landmarks = planted(random).landmarks;
    hide(9, kFoliage_m, landmarks);
    add_bushes(random, 0.5, landmarks);
    const std::vector<Landmark> before = named(landmarks);
    std::reverse(landmarks.begin(), landmarks.end());
    std::vector<Landmark> after = named(landmarks);
    std::reverse(after.begin(), after.end());
    ASSERT_EQ(before.size(), after.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_EQ(before[i].label, after[i].label);
      EXPECT_EQ(before[i].row, after[i].row);
      EXPECT_EQ(before[i].position, after[i].position);
    }
  }
}

TEST(HiddenTrees, AMapWithoutRowsHasNoGaps) {
  std::mt19937_64 random(5);
  std::vector<Landmark> landmarks = planted(random).landmarks;
  name_trees_in_gaps(landmarks);
  for (const Landmark& l : landmarks) EXPECT_EQ(l.row, 0);
  landmarks.clear();
  name_trees_in_gaps(landmarks);
  EXPECT_TRUE(landmarks.empty());
}

}  // namespace
}  // namespace orchard::mapping
