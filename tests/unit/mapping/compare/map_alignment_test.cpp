// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/map_alignment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>

#include "unit/central_difference.hpp"
#include "unit/mapping/compare/two_drives.hpp"
#include "unit/nees_band.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

constexpr double kDeg = 3.14159265358979323846 / 180.0;

/// Largest distance between where the alignment and the truth put trees of b.
double error_m(const MapAlignment& alignment, const geometry::Pose2& T_a_b, const DrivenMap& b) {
  double error = 0.0;
  for (const Landmark& l : b.landmarks) {
    const Vector2d p(l.x_m, l.y_m);
    error = std::max(error, (transform(alignment.T_a_b, p) - transform(T_a_b, p)).norm());
  }
  return error;
}

void change_some(Block& block, double fraction, Dice& dice) {
  for (TrueTree& t : block.trees) {
    if (dice.uniform(0, 1) < fraction) t.stands = !t.stands;
  }
}

TEST(MapAlignment, FindsOffsetAndTurnOfTheSameBlock) {
  for (int seed = 1; seed <= 4; ++seed) {
    Dice dice(static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 10, 30);
    const DrivenMap a = drive_through(block, Drive{}, dice);
    change_some(block, 0.05, dice);
    Drive later;
    later.T_map_block = {dice.uniform(-3, 3), dice.uniform(-3, 3), dice.uniform(-0.03, 0.03)};
    const DrivenMap b = drive_through(block, later, dice);
    const MapAlignment alignment =
        align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), MapAlignmentConfig{});
    EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << seed << ": " << alignment.reason;
    EXPECT_LT(error_m(alignment, inverse(later.T_map_block), b), 0.13) << seed;
    EXPECT_GT(alignment.pairs.size(), 240u);
    for (const LandmarkPair& pair : alignment.pairs) {
      EXPECT_EQ(a.tree_of[static_cast<std::size_t>(pair.a)],
                b.tree_of[static_cast<std::size_t>(pair.b)]);
    }
  }
}

TEST(MapAlignment, FindsAnyPlaceOfPartlyOverlappingMaps) {
  for (int seed = 1; seed <= 3; ++seed) {
    Dice dice(100 + static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 10, 30);
    Drive first, second;
    first.last_aisle = 6;
    second.first_aisle = 4;
    second.along_min_m = 15.0;
    second.T_map_block = {dice.uniform(-500, 500), dice.uniform(-500, 500),
                          dice.uniform(-3.1, 3.1)};
    const DrivenMap a = drive_through(block, first, dice);
    change_some(block, 0.05, dice);
    const DrivenMap b = drive_through(block, second, dice);
    MapAlignmentConfig config;
    config.any_place = true;
    const MapAlignment alignment =
        align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), config);
    EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << seed << ": " << alignment.reason;
    EXPECT_LT(error_m(alignment, inverse(second.T_map_block), b), 0.25) << seed;
  }
}

TEST(MapAlignment, RobotsThatFractionTwoRowsAreLaidRightAndThoseThatFractionNoneAreRefused) {
  MapAlignmentConfig config;
  config.any_place = true;
  for (int seed = 1; seed <= 2; ++seed) {
    Dice dice(400 + static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 10, 30);
    Drive first, second, apart;
    first.last_aisle = 3;
    second.first_aisle = 3;  // from the other side of the block, in a frame of its own
    second.T_map_block = {30.0, -20.0, 3.14159};
    apart = second;
    apart.first_aisle = 6;
    const DrivenMap a = drive_through(block, first, dice);
    const DrivenMap b = drive_through(block, second, dice);
    const DrivenMap c = drive_through(block, apart, dice);
    const MapAlignment alignment =
        align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), config);
    EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << seed << ": " << alignment.reason;
    EXPECT_LT(error_m(alignment, inverse(second.T_map_block), b), 0.5) << seed;
    // rows that end alike lie upon each other however one shifts them by a row
    EXPECT_NE(align_maps(a.landmarks, c.landmarks, view_of(a), view_of(c), config).status,
              AlignmentStatus::kAligned)
        << seed;
  }
}

TEST(MapAlignment, CovarianceCoversTheError) {
  double sum = 0.0;
  constexpr int kNum = 30;
  for (int seed = 1; seed <= kNum; ++seed) {
    Dice dice(200 + static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 4, 20);
    Drive drive = whole_drive(4, 20);
    drive.bend_m = 0.0;
    const DrivenMap a = drive_through(block, drive, dice);
    drive.T_map_block = {0.7, -0.4, 0.02};
    const DrivenMap b = drive_through(block, drive, dice);
    const MapAlignment alignment =
        align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), MapAlignmentConfig{});
    ASSERT_EQ(alignment.status, AlignmentStatus::kAligned) << seed << ": " << alignment.reason;
    const geometry::Pose2 truth = inverse(drive.T_map_block);
    const Eigen::Vector3d e = alignment.T_a_b.vector() - truth.vector();
    sum += e.dot(alignment.covariance.inverse() * e) / kNum;
  }
  const auto band = orchard::test::nees_band(3, kNum);
  EXPECT_GT(sum, band.least);
  EXPECT_LT(sum, band.most);
}

TEST(MapAlignment, SaysWhenAShiftByATreeFitsAsWell) {
  // planted like a chessboard, all trunks alike, none missing, and neither drive saw an end
  Dice dice(1);
  Block block = plant_block(dice, 12, 60, 0.0, 0.0, 0.0);
  Drive drive;
  drive.first_aisle = 3;
  drive.last_aisle = 9;
  drive.along_min_m = 30.0;
  drive.along_max_m = 90.0;
  const DrivenMap a = drive_through(block, drive, dice);
  const DrivenMap b = drive_through(block, drive, dice);
  const MapAlignment free =
      align_maps(a.landmarks, b.landmarks, DetectionMap(), DetectionMap(), MapAlignmentConfig{});
  EXPECT_EQ(free.status, AlignmentStatus::kAmbiguous);
  EXPECT_NEAR(free.rival_offset_m, 2.0, 0.2);
  EXPECT_THAT(free.reason, HasSubstr("shifted by another 2."));
  // who knows that the frames agree within less than half a spacing need not be asked
  MapAlignmentConfig close;
  close.offset_max_m = 0.9;
  const MapAlignment known =
      align_maps(a.landmarks, b.landmarks, DetectionMap(), DetectionMap(), close);
  EXPECT_EQ(known.status, AlignmentStatus::kAligned) << known.reason;
}

TEST(MapAlignment, RowEndsTellWhenBothDrivesLookedThere) {
  Dice dice(2);
  Block block = plant_block(dice, 10, 20, 0.0, 0.0, 0.0);
  Drive drive;
  drive.last_aisle = 10;
  drive.bend_m = drive.position_sd_m = 0.02;
  drive.along_min_m = -5.0;
  drive.along_max_m = 43.0;
  const DrivenMap a = drive_through(block, drive, dice);
  const DrivenMap b = drive_through(block, drive, dice);
  const MapAlignment alignment =
      align_maps(a.landmarks, b.landmarks, view_of(a), view_of(b), MapAlignmentConfig{});
  EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << alignment.reason;
  EXPECT_LT(error_m(alignment, geometry::Pose2{}, b), 0.1);
}

TEST(MapAlignment, RefusesAnotherOrchard) {
  int num_aligned = 0;
  for (int seed = 1; seed <= 10; ++seed) {
    Dice dice(300 + static_cast<std::uint64_t>(seed));
    Block block = plant_block(dice, 6, 25);
    Block other = plant_block(dice, 6, 25);
    Drive drive = whole_drive(6, 25);
    const DrivenMap a = drive_through(block, drive, dice);
    const DrivenMap b = drive_through(other, drive, dice);
    const MapAlignment alignment =
        align_maps(a.landmarks, b.landmarks, DetectionMap(), DetectionMap(), MapAlignmentConfig{});
    num_aligned += alignment.status == AlignmentStatus::kAligned;
  }
  EXPECT_EQ(num_aligned, 0);
}

TEST(MapAlignment, ScatteredPolesAndMapsTooSmall) {
  Dice dice(5);
  std::vector<Landmark> a, b;
  const geometry::Pose2 T_b_a{40.0, -12.0, 170.0 * kDeg};
  for (int i = 0; i < 12; ++i) {
    const Vector2d p(dice.uniform(0, 9), dice.uniform(0, 6));
    Landmark l = test::landmark(i + 1, detection::Label::kObject, p.x(), p.y(), 0.05, 20);  // poles
    a.push_back(l);
    const Vector2d q = transform(T_b_a, p);
    l.x_m = q.x() + dice.normal(0.03);
    l.y_m = q.y() + dice.normal(0.03);
    if (i != 4) b.push_back(l);
  }
  MapAlignmentConfig config;
  config.any_place = true;
  const MapAlignment alignment = align_maps(a, b, DetectionMap(), DetectionMap(), config);
  EXPECT_EQ(alignment.status, AlignmentStatus::kAligned) << alignment.reason;
  EXPECT_EQ(alignment.pairs.size(), 11u);
  EXPECT_NEAR(alignment.T_a_b.yaw_rad, -170.0 * kDeg, 0.02);
  config.any_place = false;
  EXPECT_EQ(align_maps(a, b, DetectionMap(), DetectionMap(), config).status,
            AlignmentStatus::kNone);
  b.resize(2);
  EXPECT_EQ(align_maps(a, b, DetectionMap(), DetectionMap(), config).status,
            AlignmentStatus::kNone);
  EXPECT_EQ(align_maps(a, {}, DetectionMap(), DetectionMap(), config).status,
            AlignmentStatus::kNone);
}

TEST(LandmarkPairs, TheirDistanceIsToldByTheErrorsOfBothMaps) {
  Landmark a, b;
  a.se_x_m = 0.03, a.se_y_m = 0.0, b.se_x_m = 0.0, b.se_y_m = 0.04;
  const std::vector<LandmarkPair> pairs(2);
  EXPECT_NEAR(told_rms_m({a}, {b}, pairs), 0.05, 1e-12);
  EXPECT_EQ(told_rms_m({a}, {b}, {}), 0.0);
}

TEST(LandmarkPairs, AreFoundAgainInCorrectedLists) {
  const auto ids = [](const std::vector<std::int32_t>& of) {
    std::vector<Landmark> landmarks(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) landmarks[i].id = of[i];
    return landmarks;
  };
  std::vector<LandmarkPair> pairs(3);
  for (std::int32_t k = 0; k < 3; ++k) {
    pairs[static_cast<std::size_t>(k)].a = k, pairs[static_cast<std::size_t>(k)].b = 2 - k;
  }
  // 1-6, 2-5, 3-4; people deleted 1 and 4, and added 9.
  const auto now = pairs_in(pairs, ids({1, 2, 3}), ids({4, 5, 6}), ids({2, 3, 9}), ids({6, 5}));
  ASSERT_EQ(now.size(), 1u);
  EXPECT_EQ(now[0].a, 0);
  EXPECT_EQ(now[0].b, 1);
}

}  // namespace
}  // namespace orchard::mapping
