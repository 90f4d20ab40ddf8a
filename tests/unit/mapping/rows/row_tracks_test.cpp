// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_tracks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace orchard::mapping {
namespace {

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

}  // namespace
}  // namespace orchard::mapping
