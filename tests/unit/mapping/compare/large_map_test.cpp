// SPDX-License-Identifier: BSD-3-Clause
// Maps of many thousand trees in frames that have nothing in common: the truth is how the block was
// planted.
#include <gtest/gtest.h>

#include "mapping/compare/map_alignment.hpp"
#include "unit/mapping/compare/large_block.hpp"

namespace orchard::mapping {
namespace {

constexpr int kNumRows = 20;
constexpr int kNumPlaces = 260;

MapAlignment laid(const DrivenMap& a, const DrivenMap& b) {
  MapAlignmentConfig config;
  config.any_place = true;
  return align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), config);
}

Drive drive_of(int first_aisle, int last_aisle) {
  Drive drive;
  drive.first_aisle = first_aisle;
  drive.last_aisle = last_aisle;
  drive.along_max_m = 2.0 * kNumPlaces + 1.0;
  return drive;
}

TEST(LargeMaps, AreLaidOnEachOtherWhereTheyOverlap) {
  Dice dice(7);
  Block block = plant_block(dice, kNumRows, kNumPlaces);
  const DrivenMap a = drive_through_large(block, drive_of(0, 14), dice);
  for (TrueTree& t : block.trees) {
    if (dice.uniform(0, 1) < 0.05) t.stands = !t.stands;
  }
  Drive second = drive_of(10, kNumRows);
  second.T_map_block = {310.0, -120.0, 2.2};
  const DrivenMap b = drive_through_large(block, second, dice);
  ASSERT_GT(a.landmarks.size(), 3000u);
  const MapAlignment alignment = laid(a, b);
  ASSERT_EQ(alignment.status, AlignmentStatus::kAligned) << alignment.reason;
  EXPECT_GT(alignment.pairs.size(), 900u);
  for (const LandmarkPair& pair : alignment.pairs) {
    EXPECT_EQ(a.tree_of[static_cast<std::size_t>(pair.a)],
              b.tree_of[static_cast<std::size_t>(pair.b)]);
  }
}

TEST(LargeMaps, OfTwoBlocksAreRefused) {
  Dice dice(8);
  const Block one = plant_block(dice, kNumRows, kNumPlaces);
  const Block other = plant_block(dice, kNumRows, kNumPlaces);
  const DrivenMap a = drive_through_large(one, drive_of(0, kNumRows), dice);
  const DrivenMap b = drive_through_large(other, drive_of(0, kNumRows), dice);
  EXPECT_NE(laid(a, b).status, AlignmentStatus::kAligned);
}

TEST(LargeMaps, PointsFarFromAllOthersAreFoundInBoundedMemory) {
  const geometry::IndexedPoints points(
      {{0.0, 0.0}, {1e9, -1e9}, {0.5, 0.0}, {-1e9, 3.0}, {0.0, 0.4}});
  EXPECT_EQ(points.within({0.0, 0.0}, 0.6), (std::vector<std::int32_t>{0, 2, 4}));
  EXPECT_EQ(points.nearest({1e9, -1e9}, 1.0), 1);
  EXPECT_EQ(points.nearest({5e8, 5e8}, 10.0), -1);
  EXPECT_EQ(points.nearest_few({-0.1, 0.0}, 5.0, 2), (std::vector<std::int32_t>{0, 4}));
  EXPECT_TRUE(geometry::IndexedPoints({}).within({0.0, 0.0}, 5.0).empty());
}

}  // namespace
}  // namespace orchard::mapping
