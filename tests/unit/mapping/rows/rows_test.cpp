// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "mapping/rows/row_numbers.hpp"
#include "mapping/rows/row_tracks.hpp"
#include "unit/mapping/rows/planted_rows.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;

using orchard::test::Plan;
using orchard::test::plant;
using orchard::test::Planted;
using orchard::test::random_plan;

RowsConfig counted_along(const Planted& block) {
  RowsConfig config;
  config.numbering = RowNumbering::kDirection;
  config.forward_deg = block.forward_deg;
  return config;
}

/// Trees whose numbers are not those they were planted with.
int num_wrong(const Planted& block, const RowsConfig& config) {
  std::vector<Landmark> landmarks = block.landmarks;
  number_landmarks(find_rows(landmarks, config), landmarks);
  int wrong = 0;
  for (const Landmark& l : landmarks) {
    const auto planted = block.numbers.find(l.id);
    const auto truth = planted == block.numbers.end() ? std::make_pair(0, 0) : planted->second;
    wrong += std::make_pair(l.row, l.position) != truth;
  }
  return wrong;
}

TEST(Rows, NoneAreFoundWhereNoneAreWanted) {
  std::mt19937_64 random(1);
  const Planted block = plant(random_plan(random), random);
  RowsConfig config;
  EXPECT_FALSE(find_rows(block.landmarks, config).empty());
  config.numbering = RowNumbering::kNone;
  EXPECT_TRUE(find_rows(block.landmarks, config).empty());
}

TEST(Rows, NumbersTwoHundredRandomOrchards) {
  int wrong_orchards = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    const Planted block = plant(random_plan(random), random);
    const int wrong = num_wrong(block, counted_along(block));
    if (wrong > 0) {
      ++wrong_orchards;
      ADD_FAILURE() << "seed " << seed << ": " << wrong << " of " << block.landmarks.size();
    }
  }
  EXPECT_EQ(wrong_orchards, 0);
}

/// What find_rows numbers a planted block.
std::map<std::int32_t, std::pair<int, int>> numbered(const std::vector<Landmark>& landmarks,
                                                     const RowsConfig& config) {
  std::vector<Landmark> all = landmarks;
  number_landmarks(find_rows(all, config), all);
  std::map<std::int32_t, std::pair<int, int>> numbers;
  for (const Landmark& l : all) numbers[l.id] = {l.row, l.position};
  return numbers;
}

TEST(Rows, NumbersStayWhenOneTreeInTwentyChanges) {
  for (std::uint64_t seed = 301; seed <= 320; ++seed) {
    std::mt19937_64 random(seed);
    Plan plan;
    plan.heading_rad = 1.2;
    Planted block = plant(plan, random);
    const RowsConfig config;  // automatic
    const auto before = numbered(block.landmarks, config);
    // another day's map: other noise, a tree in forty gone, and as many planted in gaps
    std::vector<Landmark> later;
    for (Landmark l : block.landmarks) {
      if (l.label == Label::kTree && random() % 40 == 0) continue;
      l.x_m += 0.02 * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
      l.y_m += 0.02 * (static_cast<double>(random() % 2001) / 1000.0 - 1.0);
      later.push_back(l);
    }
    int new_id = 10000;
    for (const Row& row : find_rows(block.landmarks, config)) {
      for (const RowSlot& place : row.places) {
        if (place.landmark_id != 0 || random() % 4 != 0) continue;
        later.push_back(test::tree(++new_id, place.p_map.x(), place.p_map.y()));
      }
    }
    std::shuffle(later.begin(), later.end(), random);
    EXPECT_GT(new_id, 10000);
    for (const auto& [id, number] : numbered(later, config)) {
      const auto was = before.find(id);
      if (was == before.end()) continue;
      EXPECT_EQ(number, was->second) << "seed " << seed << " id " << id;
    }
  }
}

TEST(Rows, DoesNotDependOnTheOrderOfTheLandmarks) {
  std::mt19937_64 random(401);
  Plan plan;
  plan.bend_m = 90.0;
  Planted block = plant(plan, random);
  const auto first = numbered(block.landmarks, {});
  std::shuffle(block.landmarks.begin(), block.landmarks.end(), random);
  EXPECT_EQ(numbered(block.landmarks, {}), first);
}

TEST(Rows, GapsStandWhereTreesAreMissing) {
  Plan plan;
  plan.num_rows = 3;
  plan.num_places = 12;
  plan.unequal = plan.noise_m = plan.missing = plan.post_fraction = 0.0;
  plan.heading_rad = 0.0;
  std::mt19937_64 random(1);
  Planted block = plant(plan, random);
  // without the fifth and sixth tree of the middle row
  auto& all = block.landmarks;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [&](const Landmark& l) {
                             const auto n = block.numbers.at(l.id);
                             return n.first == 2 && (n.second == 5 || n.second == 6);
                           }),
            all.end());
  const std::vector<Row> rows = find_rows(all, counted_along(block));
  ASSERT_EQ(rows.size(), 3u);
  ASSERT_EQ(rows[1].places.size(), 12u);
  EXPECT_NEAR(rows[1].spacing_m, 2.0, 1e-9);
  for (const RowSlot& place : rows[1].places) {
    EXPECT_EQ(place.landmark_id == 0, place.position == 5 || place.position == 6);
    EXPECT_NEAR(place.p_map.x(), -11.0 + 2.0 * (place.position - 1), 1e-9);
    EXPECT_NEAR(place.p_map.y(), 0.0, 1e-9);
  }
}

TEST(Rows, BeginAtTheCornerNearestToTheOrigin) {
  Plan plan;
  plan.missing = 0.0;
  std::mt19937_64 random(2);
  const Planted block = plant(plan, random);
  std::map<std::pair<int, int>, const Landmark*> at;
  for (const Landmark& l : block.landmarks) {
    if (block.numbers.count(l.id)) at[block.numbers.at(l.id)] = &l;
  }
  for (const int row : {1, plan.num_rows}) {
    for (const int position : {1, plan.num_places}) {
      const Landmark& corner = *at.at({row, position});
      RowsConfig config;
      config.numbering = RowNumbering::kOrigin;
      config.origin_m = {corner.x_m + 0.4, corner.y_m - 0.3};
      config.first_row = 11;
      config.first_position = 101;
      EXPECT_EQ(numbered(block.landmarks, config).at(corner.id), std::make_pair(11, 101));
    }
  }
}

TEST(Rows, AHedgeAcrossTheirEndsChangesNoNumber) {
  Plan plan;
  plan.heading_rad = 0.0;
  std::mt19937_64 random(5);
  Planted block = plant(plan, random);
  for (int i = 0; i < 24; ++i) {  // 3 m beyond the last places, from the first row to the last
    block.landmarks.push_back(test::tree(5000 + i, 27.0, -14.0 + 28.0 * i / 23.0));
  }
  const auto numbers = numbered(block.landmarks, counted_along(block));
  // a lone last tree beside the hedge may be taken for one of it, and stay without a number
  int num_unnumbered = 0;
  for (const auto& [id, planted] : block.numbers) {
    if (numbers.at(id).first == 0) {
      ++num_unnumbered;
    } else {
      EXPECT_EQ(numbers.at(id), planted) << id;
    }
  }
  EXPECT_LE(num_unnumbered, 1);
  // one of the hedge may stand just where a row goes on, but it is no row itself
  int num_numbered = 0;
  for (int i = 0; i < 24; ++i) num_numbered += numbers.at(5000 + i).first != 0;
  EXPECT_LE(num_numbered, plan.num_rows);
}

/// Gives trees and posts the confidences of a rig without a camera: posts pass for trees.
void take_posts_for_trees(Planted& block) {
  for (Landmark& l : block.landmarks) {
    l.probability = 1.0;
    l.roc_mean = l.label == Label::kTree ? 0.8 : 0.25;
    l.label = Label::kTree;
  }
}

TEST(Rows, PostsThatPassForTreesMoveNoNumber) {
  int wrong = 0, num_trees = 0;
  for (std::uint64_t seed = 501; seed <= 540; ++seed) {
    std::mt19937_64 random(seed);
    Planted block = plant(random_plan(random), random);
    take_posts_for_trees(block);
    wrong += num_wrong(block, counted_along(block));
    num_trees += static_cast<int>(block.numbers.size());
  }
  EXPECT_LE(wrong, 1) << "of " << num_trees;
}

TEST(Rows, WhatStandsBesideTheirEndsIsNoTreeOfThem) {
  int num_cut = 0, num_ends = 0;
  for (std::uint64_t seed = 521; seed <= 540; ++seed) {
    std::mt19937_64 random(seed);
    Plan plan = random_plan(random);
    plan.post_fraction = 0.0;
    plan.missing = 0.0;
    Planted block = plant(plan, random);
    // beyond the last tree of every second row, a third of a spacing off its line
    std::map<int, std::map<int, std::pair<double, double>>> rows;
    for (const Landmark& l : block.landmarks) {
      const auto [row, position] = block.numbers.at(l.id);
      rows[row][position] = {l.x_m, l.y_m};
    }
    for (auto& [row, places] : rows) {
      if (row % 2 == 0) continue;
      const auto [x_m, y_m] = places.rbegin()->second;
      const auto [before_x_m, before_y_m] = std::next(places.rbegin())->second;
      const double dx = x_m - before_x_m, dy = y_m - before_y_m;
      Landmark aside;
      aside.id = 9000 + row;
      aside.label = Label::kTree;
      aside.x_m = x_m + dx - 0.35 * dy;
      aside.y_m = y_m + dy + 0.35 * dx;
      block.landmarks.push_back(aside);
    }
    number_landmarks(find_rows(block.landmarks, counted_along(block)), block.landmarks);
    for (const Landmark& l : block.landmarks) {
      if (l.id <= 9000) {
        EXPECT_EQ(std::make_pair(l.row, l.position), block.numbers.at(l.id)) << "seed " << seed;
        continue;
      }
      ++num_ends;
      num_cut += l.row == 0;
    }
  }
  EXPECT_GE(num_cut, num_ends * 9 / 10) << "of " << num_ends;
}

TEST(Rows, PartsOfBushesNeitherBreakNorShiftRows) {
  int num_wrong = 0, num_trees = 0;
  for (std::uint64_t seed = 601; seed <= 620; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double a, double b) {
      return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    Plan plan;
    plan.heading_rad = 0.0;
    plan.unequal = 0.05;
    Planted block = plant(plan, random);
    take_posts_for_trees(block);
    // bushes as each of their sides shows them: some parts thick as trunks, in a row, off the trees
    int id = 9000;
    for (int bush = 0; bush < 5; ++bush) {
      const double x_m = -24.0 + 2.0 * static_cast<double>(random() % 24) + uniform(0.8, 1.2);
      const double y_m = 14.0 - 4.0 * static_cast<double>(random() % 8) + uniform(-0.2, 0.2);
      for (int part = 0; part < 4; ++part) {
        Landmark l;
        l.id = ++id;
        l.label = Label::kTree;
        l.x_m = x_m + uniform(-0.3, 0.3);
        l.y_m = y_m + uniform(-0.3, 0.3);
        l.probability = 1.0;
        l.roc_mean = part == 0 ? 0.55 : uniform(0.2, 0.35);
        block.landmarks.push_back(l);
      }
    }
    const RowsConfig config = counted_along(block);
    EXPECT_EQ(find_rows(block.landmarks, config).size(), 8u) << "seed " << seed;
    const auto numbers = numbered(block.landmarks, config);
    for (const auto& [tree, planted] : block.numbers) num_wrong += numbers.at(tree) != planted;
    num_trees += static_cast<int>(block.numbers.size());
  }
  EXPECT_LE(num_wrong, num_trees / 100) << "of " << num_trees;
}

TEST(Rows, OfTwoInOnePlaceTheSurerOneIsTheTree) {
  Plan plan;
  plan.heading_rad = 0.0;
  plan.missing = 0.0;
  std::mt19937_64 random(7);
  Planted block = plant(plan, random);
  take_posts_for_trees(block);
  const int num_objects = static_cast<int>(block.landmarks.size());
  for (int i = 0; i < num_objects; i += 9) {  // beside a tree, towards either side
    Landmark l = block.landmarks[static_cast<std::size_t>(i)];
    if (block.numbers.count(l.id) == 0) continue;
    l.id += 5000;
    l.x_m += i % 2 == 0 ? 0.35 : -0.35;
    l.roc_mean = 0.45;
    block.landmarks.push_back(l);
  }
  EXPECT_EQ(num_wrong(block, counted_along(block)), 0);
}

/// The number of rows among which none holds a landmark of id 5000 or more.
int rows_without_clutter(const std::vector<Row>& rows) {
  return static_cast<int>(std::count_if(rows.begin(), rows.end(), [](const Row& row) {
    return std::none_of(row.places.begin(), row.places.end(),
                        [](const RowSlot& place) { return place.landmark_id >= 5000; });
  }));
}

TEST(Rows, WhatStandsInLineByChanceIsNoRow) {
  for (std::uint64_t seed = 601; seed <= 640; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double a, double b) {
      return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    Plan plan;
    plan.num_rows = 5;
    plan.num_places = 10;
    plan.row_spacing_m = 4.3;
    plan.tree_spacing_m = 3.2;
    plan.heading_rad = 0.0;
    plan.post_fraction = 0.0;
    Planted block = plant(plan, random);
    const auto add = [&](int id, double x_m, double y_m) {
      block.landmarks.push_back(test::tree(id, x_m, y_m));
    };
    // hedge pieces along the outermost row, half a pitch beyond it, at any distance of each other
    double x_m = -16.0;
    for (int k = 0; x_m < 16.0; ++k) {
      add(5000 + k, x_m, 8.6 + uniform(2.0, 2.6));
      x_m += uniform(0.7, 5.0);
    }
    // and a few as regular as trees, but where no row fits between two
    for (int k = 0; k < 4; ++k) add(6000 + k, -6.0 + 3.2 * k + uniform(-0.2, 0.2), 2.0);
    const std::vector<Row> rows = find_rows(block.landmarks, counted_along(block));
    EXPECT_EQ(rows.size(), 5u) << "seed " << seed;
    EXPECT_GE(rows_without_clutter(rows), 4)
        << "one may pass for a row's missing tree, seed " << seed;
  }
}

TEST(Rows, FindsNoneInTooLittle) {
  EXPECT_TRUE(find_rows({}, {}).empty());
  std::vector<Landmark> two(2);
  two[0].label = two[1].label = Label::kTree;
  two[1].x_m = 2.0;
  EXPECT_TRUE(find_rows(two, {}).empty());
  std::vector<Landmark> same(5, two[0]);  // all in one place
  EXPECT_TRUE(find_rows(same, {}).empty());
}

constexpr double kSpacing_m = 2.0;
constexpr int kTrees = 12;

/// Three rows of trees, straight or on arcs of `radius_m`, off their lines to either side.
struct Rows {
  std::vector<Eigen::Vector2d> p_map;
  std::vector<RowChain> chains;

  std::vector<RowTrack> tracks() const {
    const std::vector<double> strengths(p_map.size(), 1.0);
    return row_tracks(p_map, strengths, local_rows(p_map, kSpacing_m, chains), chains);
  }
};

Rows rows(double radius_m, double beside_m = 0.03) {
  Rows all;
  for (int row = 0; row < 3; ++row) {
    RowChain chain;
    for (int i = 0; i < kTrees; ++i) {
      const double along_m = kSpacing_m * i, off_m = i % 2 == 0 ? beside_m : -beside_m;
      const double r_m = radius_m + 4.0 * row + off_m, angle_rad = along_m / radius_m;
      chain.push_back(static_cast<std::int32_t>(all.p_map.size()));
      all.p_map.push_back(
          {r_m * std::sin(angle_rad), r_m * (1.0 - std::cos(angle_rad)) - 4.0 * row - off_m});
    }
    all.chains.push_back(chain);
  }
  return all;
}

int num_in(const std::vector<RowTrack>& tracks, std::int32_t tree) {
  int num = 0;
  for (const RowTrack& track : tracks) {
    if (track.chain.size() < kRowTreesMin) continue;
    num += static_cast<int>(std::count(track.chain.begin(), track.chain.end(), tree));
  }
  return num;
}

TEST(RowTracks, APersonBesideAGapIsNoTreeOfTheRow) {
  for (const double radius_m : {1e6, 100.0}) {
    Rows all = rows(radius_m);
    const std::int32_t person = all.chains[1][6];
    all.p_map[static_cast<std::size_t>(person)] += Eigen::Vector2d(0.3, 0.9);
    const std::vector<RowTrack> tracks = all.tracks();
    for (std::size_t i = 0; i < all.p_map.size(); ++i) {
      const auto tree = static_cast<std::int32_t>(i);
      EXPECT_EQ(num_in(tracks, tree), tree == person ? 0 : 1) << radius_m << " tree " << i;
    }
  }
}

TEST(RowTracks, AHedgeBeyondAnEndConvictsNoTree) {
  Rows all = rows(1e6);
  const std::size_t num_trees = all.p_map.size();
  for (int i = 1; i <= 3; ++i) {  // turns off the row's line behind its last tree
    const Eigen::Vector2d last = all.p_map[static_cast<std::size_t>(all.chains[1][kTrees - 1])];
    all.chains[1].push_back(static_cast<std::int32_t>(all.p_map.size()));
    all.p_map.push_back(last + Eigen::Vector2d(1.2 * i, -1.0 * i));
  }
  const std::vector<RowTrack> tracks = all.tracks();
  for (std::size_t i = 0; i < all.p_map.size(); ++i) {
    EXPECT_EQ(num_in(tracks, static_cast<std::int32_t>(i)), i < num_trees ? 1 : 0) << i;
  }
}

TEST(RowTracks, OnlyRegularStepsTellARowFromAHedge) {
  Rows all = rows(1e6);
  std::mt19937_64 random(3);
  // Straight and parallel to the rows, so dense that some are whole spacings apart by chance.
  const auto first_of_hedge = static_cast<std::int32_t>(all.p_map.size());
  for (double x_m = 0.0; x_m < kTrees * kSpacing_m;) {
    all.p_map.push_back({x_m, -12.0});
    x_m += 0.3 + 1e-3 * static_cast<double>(random() % 700);
  }
  int num_hedges = 0;
  for (const RowTrack& track : all.tracks()) {
    if (track.chain.front() < first_of_hedge) {
      EXPECT_GT(track.log_odds_in_line, 10.0);
    } else if (track.chain.size() >= kRowTreesMin) {
      EXPECT_LT(track.log_odds_in_line, 1.0);
      ++num_hedges;
    }
  }
  EXPECT_GE(num_hedges, 1);
}

TEST(RowField, FollowsACurveBeyondItsLastTree) {
  constexpr double kRadius_m = 40.0;
  Rows all = rows(kRadius_m, 0.0);
  const double turned_rad = kTrees * kSpacing_m / kRadius_m;
  all.p_map.push_back({kRadius_m * std::sin(turned_rad), kRadius_m * (1.0 - std::cos(turned_rad))});
  const LocalRows beyond = local_rows(all.p_map, kSpacing_m, all.chains).back();
  EXPECT_NEAR(std::atan2(beyond.direction.y(), beyond.direction.x()), turned_rad, 0.02);
  EXPECT_NEAR(beyond.spacing_m, kSpacing_m, 0.25);  // longer in the outer rows
}

/// A row of landmarks with these ids, a metre apart; 0 is an empty slot.
Row row_of(int number, const std::vector<std::int32_t>& ids) {
  Row row;
  row.number = number;
  for (const std::int32_t id : ids) {
    const auto position = static_cast<std::int32_t>(row.places.size() + 1);
    row.places.push_back({position, id, {1.0 * position, 4.0 * number}});
  }
  return row;
}

TEST(ProbabilityByOrder, IsHowOftenItIsATreeWhereRowsGoOnOverOtherThings) {
  // beyond either end each row goes on to something else, and again, with a probability of 0.4
  std::mt19937_64 random(7);
  std::bernoulli_distribution goes_on(0.4);
  std::vector<Row> rows;
  std::vector<Landmark> landmarks;
  std::vector<char> is_tree;
  for (int number = 1; number <= 4000; ++number) {
    std::vector<std::int32_t> ids;
    const auto add = [&](bool tree) {
      Landmark l;
      l.id = static_cast<std::int32_t>(landmarks.size() + 1);
      l.probability = 0.8;
      landmarks.push_back(l);
      is_tree.push_back(tree ? 1 : 0);
      ids.push_back(l.id);
    };
    while (goes_on(random)) add(false);
    for (int k = 0; k < 12; ++k) add(true);
    while (goes_on(random)) add(false);
    rows.push_back(row_of(number, ids));
  }
  set_probability_by_order(rows, landmarks);
  std::map<double, std::pair<int, int>> counts;  // by probability: trees, all
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    auto& [trees, all] = counts[landmarks[i].probability];
    trees += is_tree[i];
    ++all;
  }
  int num_judged = 0;
  for (const auto& [probability, count] : counts) {
    if (count.second < 500) continue;
    EXPECT_NEAR(1.0 * count.first / count.second, probability, 0.03);
    ++num_judged;
  }
  EXPECT_GE(num_judged, 5);
}

TEST(ProbabilityByOrder, SaysLittleForWhatStandsOutsideAndNothingByOneRow) {
  std::vector<Landmark> landmarks(9);
  for (std::size_t i = 0; i < landmarks.size(); ++i) {
    landmarks[i].id = static_cast<std::int32_t>(i + 1);
    landmarks[i].probability = 0.8;
  }
  landmarks[8].probability = 0.01;
  const Row first = row_of(1, {1, 2, 3}), second = row_of(2, {4, 5, 0, 6, 7});
  std::vector<Landmark> beside_a_fence = landmarks;
  set_probability_by_order({first}, beside_a_fence);
  for (const Landmark& l : beside_a_fence) EXPECT_EQ(l.probability, l.id == 9 ? 0.01 : 0.8);
  set_probability_by_order({first, second}, landmarks);
  EXPECT_GT(landmarks[1].probability, landmarks[0].probability) << "farther from the end";
  EXPECT_EQ(landmarks[4].probability, landmarks[1].probability) << "an empty slot is no tree";
  EXPECT_LT(landmarks[7].probability, 0.1);
  EXPECT_EQ(landmarks[8].probability, 0.01) << "a hedge is no likelier for standing outside";
}

/// What stands within 0.3 of a spacing of an empty slot is the tree of that slot; an object there,
/// a trunk farther away and one beyond the ends of the row are not.
TEST(RowNumbers, ATrunkBesideAnEmptySlotHasItsNumber) {
  std::vector<Landmark> landmarks;
  for (const int position : {2, 3, 5, 7, 8, 10}) {
    landmarks.push_back(test::tree(position, 0.0, 2.0 * position));
    landmarks.back().row = 1;
    landmarks.back().position = position;
  }
  landmarks.push_back(test::tree(24, 0.5, 8.1));
  landmarks.push_back(test::tree(26, 0.7, 12.0));
  landmarks.push_back(test::landmark(29, Label::kObject, 0.1, 18.0));
  landmarks.push_back(test::tree(31, 0.0, 22.0));
  number_trunks_in_gaps(landmarks);
  const std::vector<Row> rows = numbered_rows(landmarks);
  ASSERT_EQ(rows.size(), 1u);
  std::vector<std::int32_t> ids;
  for (const RowSlot& slot : rows[0].places) ids.push_back(slot.landmark_id);
  EXPECT_EQ(ids, (std::vector<std::int32_t>{2, 3, 24, 5, 0, 7, 8, 0, 10}));
}

}  // namespace

}  // namespace orchard::mapping
