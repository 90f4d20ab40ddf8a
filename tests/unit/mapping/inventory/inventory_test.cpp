// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/inventory/inventory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

Landmark tree(std::int32_t id, std::int32_t row, std::int32_t position, double width_m) {
  Landmark l = test::tree(id, 4.0 * row, 2.0 * position, width_m);
  l.row = row;
  l.position = position;
  l.probability = 0.99;
  return l;
}

TEST(Inventory, TrunkAreaIsThatOfACircleInSquareCentimetres) {
  EXPECT_NEAR(tcsa_cm2(0.10), 78.5398, 1e-4);  // pi/4 x 10 cm x 10 cm
  EXPECT_NEAR(tcsa_cm2(0.0), 0.0, 0.0);
}

TEST(Inventory, CountsTreesGapsAndAreasByRow) {
  std::vector<Landmark> map{tree(1, 1, 2, 0.10), tree(2, 1, 3, 0.20), tree(3, 1, 6, 0.0),
                            tree(4, 3, 1, 0.10), tree(5, 0, 0, 0.30), tree(6, 3, 0, 0.10)};
  map[0].width_sd_m = 0.002;
  map[1].width_sd_m = 0.003;
  map[3].probability = 0.9;
  map[5].probability = 0.6;
  map.push_back(tree(7, 0, 0, 0.5));
  map.back().label = detection::Label::kObject;
  map.push_back(tree(8, 0, 0, 0.5));
  map.back().label = detection::Label::kUnseen;
  const Inventory inventory = compute_inventory(map);
  ASSERT_EQ(inventory.rows.size(), 2u);
  const RowInventory &one = inventory.rows[0], &three = inventory.rows[1];
  EXPECT_EQ(one.row, 1);
  EXPECT_EQ(one.num_trees, 3);
  EXPECT_EQ(one.num_measured, 2);
  ASSERT_EQ(one.gaps.size(), 2u);
  EXPECT_EQ(one.gaps[0].position, 4);
  EXPECT_EQ(one.gaps[1].position, 5);
  EXPECT_NEAR(one.gaps[1].p_map.y(), 10.0, 1e-9) << "between its neighbours";
  EXPECT_NEAR(one.diameter_mean_m, 0.15, 1e-12);
  EXPECT_NEAR(one.tcsa_cm2, M_PI / 4.0 * (100.0 + 400.0), 1e-9);
  // The area's error is that of a ring as thick as half the diameter's: pi/2 d dd.
  EXPECT_NEAR(one.tcsa_sd_cm2, std::hypot(M_PI / 2.0 * 10.0 * 0.2, M_PI / 2.0 * 20.0 * 0.3), 1e-9);
  EXPECT_EQ(three.num_trees, 2);
  EXPECT_TRUE(three.gaps.empty());
  EXPECT_EQ(inventory.all.num_trees, 5);
  EXPECT_EQ(inventory.all.gaps.size(), 2u);
  EXPECT_EQ(inventory.kinds.of(Kind::kObject), 1);
  EXPECT_EQ(inventory.kinds.of(Kind::kUnseen), 1);
  EXPECT_EQ(inventory.certainty.num_sure, 3);
  EXPECT_EQ(inventory.certainty.num_likely, 1);
  EXPECT_EQ(inventory.certainty.num_unsure, 1);
}

TEST(Inventory, ARowIsAsSteepAsItsTreesRise) {
  std::vector<Landmark> map;
  for (int i = 1; i <= 11; ++i) {  // 20 m, a tree every 2 m, rising by 8 %
    map.push_back(tree(i, 1, i, 0.10));
    map.back().z_m = 300.0 + 0.16 * i;
    map.back().z_sd_m = 0.05;
  }
  map[4].z_m = 0.0, map[4].z_sd_m = 0.0;  // unknown
  map[6].z_m += 10.0, map[6].z_sd_m = 10.0;
  const auto slope = compute_inventory(map).rows.at(0).slope;
  ASSERT_TRUE(slope);
  EXPECT_NEAR(slope->percent, 8.0, 0.01);
  EXPECT_NEAR(slope->rise_m, 1.6, 0.002);
  // 0.05 m, 6.3 m (root mean square) from the middle, of as many trees as are 8 m apart.
  EXPECT_NEAR(slope->percent_sd, 100.0 * 0.05 / 6.3 / std::sqrt(1.0 + 20.0 / 8.0), 0.1);
  for (std::size_t i = 2; i < map.size(); ++i) map[i].z_sd_m = 0.0;
  EXPECT_FALSE(compute_inventory(map).rows.at(0).slope) << "two heights tell no error";
}

TEST(Inventory, TrunksInNoRowAreApartAndInNoSum) {
  std::vector<Landmark> map{tree(1, 1, 1, 0.10), tree(2, 1, 2, 0.10), tree(3, 0, 0, 0.90),
                            tree(4, 0, 0, 0.80)};
  map[2].probability = 0.1;
  const Inventory orchard = compute_inventory(map);
  EXPECT_EQ(orchard.kinds.text(), "2 trees in rows, 2 other trunks");
  EXPECT_EQ(orchard.all.num_trees, 2);
  EXPECT_NEAR(orchard.all.tcsa_cm2, 2.0 * tcsa_cm2(0.10), 1e-9);
  EXPECT_EQ(orchard.other.num_trees, 2);
  EXPECT_NEAR(orchard.other.tcsa_cm2, tcsa_cm2(0.90) + tcsa_cm2(0.80), 1e-9);
  EXPECT_EQ(orchard.certainty.num_unsure, 0);
  EXPECT_EQ(diameter_histogram(map).counts, (std::vector<int>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2}));

  // A park has no rows: there all trunks are what is counted.
  for (Landmark& l : map) l.row = l.position = 0;
  const Inventory park = compute_inventory(map);
  EXPECT_EQ(park.kinds.text(), "4 trunks");
  EXPECT_EQ(park.all.num_trees, 4);
  EXPECT_EQ(park.other.num_trees, 0);
  EXPECT_TRUE(park.rows.empty());
}

TEST(Inventory, NothingAndAbsurdNumbersAreBounded) {
  EXPECT_TRUE(compute_inventory({}).rows.empty());
  EXPECT_TRUE(diameter_histogram({}).counts.empty());
  const Inventory inventory = compute_inventory(
      {tree(1, 1, 1, 0.1), tree(2, 1, 2147483647, 0.1), tree(3, 1, 2147483646, 0.1)});
  EXPECT_LE(inventory.rows[0].gaps.size(), 100000u);
}

TEST(DiameterHistogram, EveryTrunkIsInItsClass) {
  std::mt19937_64 random(5);
  for (const double mean_m : {0.05, 0.2, 0.8}) {
    std::vector<Landmark> map;
    std::normal_distribution<double> width_m(mean_m, 0.2 * mean_m);
    for (int i = 0; i < 500; ++i) map.push_back(tree(i + 1, 1, i + 1, std::abs(width_m(random))));
    map.push_back(tree(900, 1, 900, 40.0));  // no trunk; the classes stay as narrow as they are
    const DiameterHistogram histogram = diameter_histogram(map);
    EXPECT_EQ(std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0), 501);
    EXPECT_LE(histogram.counts.size(), 41u);
    EXPECT_GT(histogram.counts.size(), 5u);
    for (std::size_t i = 0; i + 1 < histogram.counts.size(); ++i) {
      int count = 0;
      for (const Landmark& l : map) {
        count += l.width_m >= histogram.class_m * static_cast<double>(i) &&
                 l.width_m < histogram.class_m * static_cast<double>(i + 1);
      }
      EXPECT_EQ(histogram.counts[i], count) << i;
    }
  }
}

TEST(Growth, IsOfTreesThatBothMapsMeasured) {
  const std::vector<Landmark> earlier{tree(1, 1, 1, 0.10), tree(2, 1, 2, 0.10), tree(3, 1, 3, 0.0)};
  const std::vector<Landmark> later{tree(1, 1, 1, 0.11), tree(2, 2, 2, 0.10), tree(3, 1, 3, 0.1)};
  MapComparison comparison;
  for (std::int32_t i = 0; i < 3; ++i) {
    MapChange change;
    change.a = i;
    change.b = i;
    comparison.changes.push_back(change);
  }
  MapChange gone;
  gone.change = Change::kMissing;
  gone.a = 1;
  comparison.changes.push_back(gone);
  const GrowthByRow growth = growth_by_row(earlier, later, comparison);
  EXPECT_EQ(growth.at(1).num_pairs, 1);
  EXPECT_NEAR(growth.at(1).tcsa_change_cm2, M_PI / 4.0 * (121.0 - 100.0), 1e-9);
  EXPECT_NEAR(growth.at(1).percent(), 21.0, 1e-9);
  EXPECT_EQ(growth.at(2).num_pairs, 1) << "by the later map's rows";
  EXPECT_EQ(growth.at(kGrowthOfAll).num_pairs, 2);
  EXPECT_NEAR(growth.at(kGrowthOfAll).percent(), 10.5, 1e-9);

  std::vector<Landmark> without_row = later;
  without_row[0].row = 0;
  const GrowthByRow in_rows = growth_by_row(earlier, without_row, comparison);
  EXPECT_EQ(in_rows.at(0).num_pairs, 1);
  EXPECT_EQ(in_rows.at(kGrowthOfAll).num_pairs, 1) << "a trunk in no row is in no sum";
}

}  // namespace
}  // namespace orchard::mapping
