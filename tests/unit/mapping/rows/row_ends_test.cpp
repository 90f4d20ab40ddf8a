// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_ends.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace orchard::mapping {
namespace {

constexpr double kSpacing_m = 2.0;
constexpr int kTrees = 12;

/// Three rows of trees, straight or on arcs of `radius_m`, off their lines by 3 cm to either side.
struct Planted {
  std::vector<Eigen::Vector2d> p_map;
  std::vector<RowChain> chains;
};

Planted rows(double radius_m) {
  Planted all;
  for (int row = 0; row < 3; ++row) {
    RowChain chain;
    for (int i = 0; i < kTrees; ++i) {
      const double along_m = kSpacing_m * i, off_m = i % 2 == 0 ? 0.03 : -0.03;
      const double r_m = radius_m + 4.0 * row + off_m, angle_rad = along_m / radius_m;
      chain.push_back(static_cast<std::int32_t>(all.p_map.size()));
      all.p_map.push_back(
          {r_m * std::sin(angle_rad), r_m * (1.0 - std::cos(angle_rad)) - 4.0 * row - off_m});
    }
    all.chains.push_back(chain);
  }
  return all;
}

TEST(RowEnds, APersonBesideAGapIsNoTreeOfTheRow) {
  for (const double radius_m : {1e6, 100.0}) {
    Planted all = rows(radius_m);
    const std::int32_t person = all.chains[1][6];
    all.p_map[static_cast<std::size_t>(person)] += Eigen::Vector2d(0.3, 0.9);
    std::vector<RowChain> expected = all.chains;
    expected[1].erase(expected[1].begin() + 6);
    trim_row_ends(all.p_map, kSpacing_m, all.chains);
    EXPECT_EQ(all.chains, expected) << radius_m;
  }
}

TEST(RowEnds, AHedgeBeyondAnEndConvictsNoTree) {
  Planted all = rows(1e6);
  const std::vector<RowChain> expected = all.chains;
  for (int i = 1; i <= 3; ++i) {  // turns off the row's line behind its last tree
    all.chains[1].push_back(static_cast<std::int32_t>(all.p_map.size()));
    const Eigen::Vector2d& last = all.p_map[static_cast<std::size_t>(expected[1].back())];
    all.p_map.push_back(last + Eigen::Vector2d(1.2 * i, -1.0 * i));
  }
  trim_row_ends(all.p_map, kSpacing_m, all.chains);
  for (const std::int32_t tree : expected[1]) {
    EXPECT_EQ(std::count(all.chains[1].begin(), all.chains[1].end(), tree), 1) << tree;
  }
}

}  // namespace
}  // namespace orchard::mapping
