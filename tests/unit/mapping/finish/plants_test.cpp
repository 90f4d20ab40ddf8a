// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/finish/plants.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "../rows/planted_rows.hpp"
#include "geometry/statistics.hpp"
#include "mapping/rows/rows.hpp"
#include "mapping/tuning.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using detection::Label;

constexpr int kBlocks = 20;
constexpr int kFirstPart = 100'000;  ///< ids of parts; those of planted trees are lower

double uniform(std::mt19937_64& random, double a, double b) {
  return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
}

test::Plan random_plan(std::mt19937_64& random) {
  test::Plan plan;
  plan.num_rows = 4 + static_cast<int>(random() % 5);
  plan.num_places = 10 + static_cast<int>(random() % 15);
  plan.tree_spacing_m = uniform(random, 1.2, 4.0);
  plan.row_spacing_m = plan.tree_spacing_m * uniform(random, 1.2, 2.0);
  plan.heading_rad = uniform(random, -3.0, 3.0);
  plan.post_fraction = 0.0;
  return plan;
}

/// Trees as map files have them: seen a hundred times.
test::Planted planted(const test::Plan& plan, std::mt19937_64& random) {
  test::Planted block = test::plant(plan, random);
  for (Landmark& l : block.landmarks) l.num_observations = 80 + static_cast<int>(random() % 40);
  return block;
}

/// The block as scans from several sides cut it: each tree with up to five stems or shoots, and
/// every third in a bush that is seen more often than its stem.
std::vector<Landmark> cut_up(const test::Planted& block, double reach_m, std::mt19937_64& random) {
  std::vector<Landmark> all = block.landmarks;
  int id = kFirstPart;
  for (const Landmark& tree : block.landmarks) {
    const auto add = [&](double away_m, Label label, int num_observations) {
      const double angle = uniform(random, 0.0, 2.0 * geometry::kPi);
      Landmark part = tree;
      part.id = ++id;
      part.label = label;
      part.num_observations = num_observations;
      part.x_m += away_m * std::cos(angle);
      part.y_m += away_m * std::sin(angle);
      all.push_back(part);
    };
    const int num = 1 + static_cast<int>(random() % 5);
    for (int k = 0; k < num; ++k) {
      add(uniform(random, 0.1, 0.9) * reach_m, random() % 2 == 0 ? Label::kTree : Label::kObject,
          5 + static_cast<int>(random() % 60));
    }
    if (random() % 3 == 0) add(0.3 * reach_m, Label::kObject, 150);
  }
  return all;
}

Landmark of_stem(const Landmark& stem, const std::vector<std::int32_t>&) { return stem; }

TEST(Plants, StemsAndShootsOfAPlantAreOneLandmark) {
  std::mt19937_64 random(1);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    const test::Plan plan = random_plan(random);
    const test::Planted block = planted(plan, random);
    const std::vector<Landmark> plants =
        join_plants(cut_up(block, 0.25 * plan.tree_spacing_m, random), {}, of_stem);
    ASSERT_EQ(plants.size(), block.landmarks.size());
    for (const Landmark& tree : block.landmarks) {
      const auto is_its_stem = [&](const Landmark& l) {
        return l.id == tree.id && l.x_m == tree.x_m && l.y_m == tree.y_m;
      };
      EXPECT_EQ(std::count_if(plants.begin(), plants.end(), is_its_stem), 1) << "tree " << tree.id;
    }
  }
}

/// Stakes midway between every third plant and the next, as a vineyard has them: they look like
/// stems.
void add_stakes(const test::Planted& block, const test::Plan& plan, std::mt19937_64& random,
                std::vector<Landmark>& all) {
  int id = 2 * kFirstPart;
  const Eigen::Vector2d half_step_m =
      0.5 * plan.tree_spacing_m *
      Eigen::Vector2d(std::cos(plan.heading_rad), std::sin(plan.heading_rad));
  for (const Landmark& tree : block.landmarks) {
    if (random() % 3 != 0) continue;
    Landmark stake = tree;
    stake.id = ++id;
    stake.x_m += half_step_m.x();
    stake.y_m += half_step_m.y();
    all.push_back(stake);
  }
}

TEST(Plants, StakesBetweenPlantsDoNotHideTheirSpacing) {
  std::mt19937_64 random(6);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    const test::Plan plan = random_plan(random);
    const test::Planted block = planted(plan, random);
    std::vector<Landmark> all = cut_up(block, 0.2 * plan.tree_spacing_m, random);
    const std::size_t num_parts = all.size();
    add_stakes(block, plan, random, all);
    const std::size_t num_stakes = all.size() - num_parts;
    EXPECT_EQ(join_plants(all, {}, of_stem).size(), block.landmarks.size() + num_stakes);
  }
}

/// Shoots and stakes anywhere in the rows, off their line by a tenth of the spacing.
void add_shoots(const test::Planted& block, const test::Plan& plan, std::mt19937_64& random,
                std::vector<Landmark>& all) {
  int id = 2 * kFirstPart;
  const Eigen::Rotation2Dd along_row(plan.heading_rad);
  for (const Landmark& tree : block.landmarks) {
    Landmark shoot = tree;
    const Eigen::Vector2d away_m =
        along_row * Eigen::Vector2d(uniform(random, 0.3, 0.7) * plan.tree_spacing_m,
                                    uniform(random, -0.1, 0.1) * plan.tree_spacing_m);
    shoot.id = ++id;
    shoot.num_observations = 20;
    shoot.x_m += away_m.x();
    shoot.y_m += away_m.y();
    all.push_back(shoot);
  }
}

TEST(Plants, NoTwoStandWithinTheReachOfTheRowsTheyMake) {
  std::mt19937_64 random(15);
  int num_joined = 0;
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    const test::Plan plan = random_plan(random);
    std::vector<Landmark> all = planted(plan, random).landmarks;
    for (int times = 0; times < 3; ++times) add_shoots(planted(plan, random), plan, random, all);
    const std::vector<Landmark> plants = join_plants(all, {}, of_stem);
    if (plants.size() == all.size()) continue;  // too few in rows
    ++num_joined;
    std::vector<double> spacings_m;
    for (const Row& row : find_rows(plants, {})) {
      spacings_m.insert(spacings_m.end(), row.places.size(), row.spacing_m);
    }
    const double reach_m = tuning::kOnePlace_spacings * geometry::median(spacings_m);
    for (const Landmark& a : plants) {
      for (const Landmark& b : plants) {
        if (a.id >= b.id) continue;
        EXPECT_GT(std::hypot(a.x_m - b.x_m, a.y_m - b.y_m), reach_m);
      }
    }
  }
  EXPECT_GE(num_joined, kBlocks / 4);
}

TEST(Plants, LandmarksThatStandApartStay) {
  std::mt19937_64 random(2);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    test::Plan plan = random_plan(random);
    plan.post_fraction = 0.3;
    const test::Planted block = planted(plan, random);
    EXPECT_EQ(join_plants(block.landmarks, {}, of_stem).size(), block.landmarks.size());
  }
}

/// A landmark beside every `step`-th tree, at a fifth of the spacing.
std::vector<Landmark> with_neighbours(const test::Planted& block, const test::Plan& plan, int step,
                                      Label label, std::mt19937_64& random) {
  std::vector<Landmark> all = block.landmarks;
  for (std::size_t i = 0; i < block.landmarks.size(); i += static_cast<std::size_t>(step)) {
    const double angle = uniform(random, 0.0, 2.0 * geometry::kPi);
    Landmark& beside = all.emplace_back(block.landmarks[i]);
    beside.id = kFirstPart + static_cast<int>(i);
    beside.label = label;
    beside.num_observations /= 2;
    beside.x_m += 0.2 * plan.tree_spacing_m * std::cos(angle);
    beside.y_m += 0.2 * plan.tree_spacing_m * std::sin(angle);
  }
  return all;
}

TEST(Plants, AFewTreesMappedTwiceAreOneEach) {
  std::mt19937_64 random(7);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    const test::Plan plan = random_plan(random);
    const test::Planted block = planted(plan, random);
    const std::vector<Landmark> all = with_neighbours(block, plan, 4, Label::kTree, random);
    EXPECT_EQ(join_plants(all, {}, of_stem).size(), block.landmarks.size());
  }
}

TEST(Plants, PlantsWhoseCommonPlacesAreOneAreOne) {
  std::mt19937_64 random(9);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    const test::Plan plan = random_plan(random);
    const test::Planted block = planted(plan, random);
    std::vector<Landmark> all = block.landmarks;
    std::map<std::int32_t, Landmark> by_id;
    // Across the row beside every fourth tree two shoots, and one that is too far from the stem.
    for (std::size_t i = 0; i < block.landmarks.size(); i += 4) {
      const double angle = plan.heading_rad + 0.5 * geometry::kPi;
      for (const double away_spacings : {0.15, 0.21, 0.36}) {
        Landmark& shoot = all.emplace_back(block.landmarks[i]);
        shoot.id = kFirstPart + static_cast<int>(all.size());
        shoot.num_observations /= 2;
        shoot.x_m += away_spacings * plan.tree_spacing_m * std::cos(angle);
        shoot.y_m += away_spacings * plan.tree_spacing_m * std::sin(angle);
      }
    }
    for (const Landmark& l : all) by_id[l.id] = l;
    const auto middle = [&](const Landmark& stem, const std::vector<std::int32_t>& trees) {
      Landmark at = stem;
      at.x_m = at.y_m = 0.0;
      for (const std::int32_t id : trees) {
        at.x_m += by_id[id].x_m / static_cast<double>(trees.size());
        at.y_m += by_id[id].y_m / static_cast<double>(trees.size());
      }
      return at;
    };
    EXPECT_EQ(join_plants(all, {}, middle).size(), block.landmarks.size());
    EXPECT_GT(join_plants(all, {}, of_stem).size(), block.landmarks.size());
  }
}

TEST(Plants, WeedsBesideTrunksAreNoPartOfThem) {
  std::mt19937_64 random(8);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("block " + std::to_string(k));
    const test::Plan plan = random_plan(random);
    const test::Planted block = planted(plan, random);
    const std::vector<Landmark> all = with_neighbours(block, plan, 2, Label::kObject, random);
    EXPECT_EQ(join_plants(all, {}, of_stem).size(), all.size());
  }
}

TEST(Plants, WithoutRowsNothingTellsStemsFromPlants) {
  std::mt19937_64 random(3);
  for (int k = 0; k < kBlocks; ++k) {
    SCOPED_TRACE("thicket " + std::to_string(k));
    test::Planted thicket;
    for (int i = 1; i <= 80; ++i) {
      const double x_m = uniform(random, 0.0, 40.0), y_m = uniform(random, 0.0, 40.0);
      thicket.landmarks.push_back(test::tree(i, x_m, y_m, 0.0, 80));
    }
    const std::vector<Landmark> all = cut_up(thicket, 0.5, random);
    EXPECT_EQ(join_plants(all, {}, of_stem).size(), all.size());
  }
}

TEST(Plants, AHedgeThroughThePlantsIsNoPartOfThem) {
  std::mt19937_64 random(5);
  const test::Plan plan = random_plan(random);
  const test::Planted block = planted(plan, random);
  std::vector<Landmark> all = cut_up(block, 0.25 * plan.tree_spacing_m, random);
  Landmark hedge = block.landmarks.front();
  hedge.id = 1;
  hedge.label = Label::kObject;
  hedge.num_observations = 500;
  hedge.length_m = 20.0;
  hedge.x_m += 0.1 * plan.tree_spacing_m;
  all.push_back(hedge);
  const std::vector<Landmark> plants = join_plants(all, {}, of_stem);
  EXPECT_EQ(plants.size(), block.landmarks.size() + 1);
  EXPECT_EQ(plants.front().id, hedge.id);
  EXPECT_EQ(plants.front().length_m, hedge.length_m);
  EXPECT_EQ(plants.front().label, Label::kObject);
}

TEST(Plants, OrderOfLandmarksDoesNotMatter) {
  std::mt19937_64 random(4);
  const test::Plan plan = random_plan(random);
  const test::Planted block = planted(plan, random);
  std::vector<Landmark> all = cut_up(block, 0.25 * plan.tree_spacing_m, random);
  const std::vector<Landmark> once = join_plants(all, {}, of_stem);
  std::shuffle(all.begin(), all.end(), random);
  const std::vector<Landmark> again = join_plants(all, {}, of_stem);
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) EXPECT_EQ(once[i].id, again[i].id);
}

}  // namespace
}  // namespace orchard::mapping
