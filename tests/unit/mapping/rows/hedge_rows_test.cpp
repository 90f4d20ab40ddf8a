// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/hedge_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace orchard::mapping {
namespace {

constexpr double kPitch_m = 4.0;

/// Row number `row` along y, its trees 2 m apart; `sd_m`: scatter of their observations per axis.
void plant(std::vector<Landmark>& map, int row, double sd_m, int num_observations) {
  for (int i = 0; i < 10; ++i) {
    Landmark l;
    l.id = 100 * row + i;
    l.label = detection::Label::kTree;
    l.row = row;
    l.position = i + 1;
    l.x_m = row * kPitch_m;
    l.y_m = 2.0 * i;
    l.width_m = 0.2;
    l.num_observations = num_observations;
    l.se_x_m = l.se_y_m = sd_m / std::sqrt(num_observations);
    map.push_back(l);
  }
}

/// A hedge 1 m deep along y.
Landmark hedge(double x_m, double from_m, double to_m) {
  Landmark l;
  l.id = 1;
  l.label = detection::Label::kObject;
  l.x_m = x_m;
  l.y_m = 0.5 * (from_m + to_m);
  l.width_m = 1.0;
  l.length_m = to_m - from_m;
  l.direction_rad = 0.5 * M_PI;
  return l;
}

TEST(HedgeRows, ARowOfPartsOfAHedgeIsNone) {
  for (const int num_observations : {3, 30}) {
    std::vector<Landmark> map;
    plant(map, 1, 0.03, 30);
    plant(map, 2, 0.03, 30);
    plant(map, 3, 0.12, num_observations);
    const auto ids = trees_of_hedge_rows(map, {hedge(3 * kPitch_m, -1.0, 19.0)});
    ASSERT_EQ(ids.size(), 10u);
    EXPECT_EQ(ids.front(), 300);
    EXPECT_EQ(ids.back(), 309);
  }
}

/// Weeds between the trees of a row are a long object, in which stems as sharp as all others stand.
TEST(HedgeRows, ARowOfTrunksInWeedsIsOne) {
  std::vector<Landmark> map;
  for (const int row : {1, 2, 3}) plant(map, row, 0.03, 30);
  EXPECT_TRUE(trees_of_hedge_rows(map, {hedge(3 * kPitch_m, -1.0, 19.0)}).empty());
}

TEST(HedgeRows, ARowThatEndsInAHedgeIsOne) {
  std::vector<Landmark> map;
  plant(map, 1, 0.03, 30);
  plant(map, 2, 0.12, 30);
  EXPECT_TRUE(trees_of_hedge_rows(map, {hedge(2 * kPitch_m, 13.0, 19.0)}).empty());
  EXPECT_TRUE(trees_of_hedge_rows(map, {hedge(2.2 * kPitch_m, -1.0, 19.0)}).empty()) << "beside it";
  EXPECT_TRUE(trees_of_hedge_rows(map, map).empty()) << "no hedge at all";
}

TEST(HedgeRows, WithoutOtherRowsNothingTells) {
  std::vector<Landmark> map;
  plant(map, 1, 0.12, 30);
  EXPECT_TRUE(trees_of_hedge_rows(map, {hedge(kPitch_m, -1.0, 19.0)}).empty());
}

}  // namespace
}  // namespace orchard::mapping
