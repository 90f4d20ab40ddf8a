// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/navigation_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "mapping/rows/row_numbers.hpp"
#include "worlds/landmark.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Rows along x, row k at y = -4 k (the first on the left), trees two metres apart.
struct Planted {
  std::vector<Landmark> landmarks;
  std::vector<Row> rows;
};

Planted plant(const std::vector<double>& y_m, int num_places, double bend = 0.0) {
  Planted p;
  for (std::size_t r = 0; r < y_m.size(); ++r) {
    for (int k = 0; k < num_places; ++k) {
      if (k == 5 && r == 1) continue;  // a gap
      const double radius_m = bend == 0.0 ? 0.0 : bend - y_m[r];
      p.landmarks.push_back(
          test::tree(static_cast<std::int32_t>(p.landmarks.size()) + 1,
                     bend == 0.0 ? 2.0 * k : radius_m * std::sin(2.0 * k / bend),
                     bend == 0.0 ? y_m[r] : bend - radius_m * std::cos(2.0 * k / bend), 0.2));
    }
  }
  RowsConfig config;
  config.numbering = RowNumbering::kDirection;
  config.forward_deg = 0.0;
  p.rows = find_rows(p.landmarks, config);
  return p;
}

TEST(NavigationGraph, AislesRunMidwayAndHeadlandsJoinThem) {
  const Planted p = plant({0.0, -4.0, -8.0, -12.0}, 11);
  ASSERT_EQ(p.rows.size(), 4u);
  const NavigationGraph graph = navigation_graph(p.landmarks, p.rows);
  EXPECT_EQ(graph.nodes.size(), 6u);
  ASSERT_EQ(graph.edges.size(), 3u + 4u);
  for (int k = 0; k < 3; ++k) {
    const NavigationEdge& aisle = graph.edges[static_cast<std::size_t>(k)];
    EXPECT_EQ(aisle.kind, EdgeKind::kAisle);
    EXPECT_EQ(aisle.row_left, k + 1);
    EXPECT_EQ(aisle.row_right, k + 2);
    for (const Vector2d& point : aisle.line_map) EXPECT_NEAR(point.y(), -4.0 * k - 2.0, 1e-9);
    EXPECT_NEAR(aisle.width_m, 4.0 - 0.2, 1e-9) << "trunk to trunk";
    EXPECT_NEAR(aisle.length_m, 20.0 + 2 * 2.0, 1e-9) << "half an aisle beyond each end";
  }
  for (std::size_t e = 3; e < 7; ++e) {
    const NavigationEdge& headland = graph.edges[e];
    EXPECT_EQ(headland.kind, EdgeKind::kHeadland);
    EXPECT_NEAR(headland.length_m, 4.0, 0.1);
    EXPECT_GE(headland.width_m, 2.0 * kHalfCorridorMin_m);
    const double x = headland.line_map.front().x();
    EXPECT_TRUE(std::abs(x + 2.0) < 1e-9 || std::abs(x - 22.0) < 1e-9) << x;
  }
}

TEST(NavigationGraph, WhatStandsInAnAisleNarrowsIt) {
  Planted p = plant({0.0, -4.0, -8.0}, 11);
  Landmark post;
  post.id = 900;
  post.label = detection::Label::kObject;
  post.x_m = 9.0;
  post.y_m = -1.2;
  post.width_m = 0.4;
  p.landmarks.push_back(post);
  const NavigationGraph graph = navigation_graph(p.landmarks, p.rows);
  // 2.5 m from the post's border to those of the other row; a tenth for the steps of the search
  EXPECT_GE(graph.edges[0].width_m, 2.4);
  EXPECT_LE(graph.edges[0].width_m, 2.6);
  EXPECT_NEAR(graph.edges[1].width_m, 3.8, 1e-9);
}

/// From a landmark's border to a way [m].
double border_to_way_m(const Landmark& l, const NavigationEdge& way) {
  double nearest_m = 1e9;
  for (std::size_t i = 1; i < way.line_map.size(); ++i) {
    for (int k = 0; k <= 100; ++k) {  // by walking it, not by the formula under test
      const Vector2d p = way.line_map[i - 1] + 0.01 * k * (way.line_map[i] - way.line_map[i - 1]);
      nearest_m = std::min(nearest_m, (p - Vector2d(l.x_m, l.y_m)).norm() - 0.5 * l.width_m);
    }
  }
  return nearest_m;
}

TEST(NavigationGraph, NoWayTouchesAnythingWhateverStandsAbout) {
  int num_ways = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    Planted p = plant({0.0, -4.0, -8.0, -12.0}, 11);
    std::mt19937_64 random(static_cast<std::uint64_t>(seed));
    const auto uniform = [&](double a, double b) {
      return a + (b - a) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    for (int k = 0; k < 12; ++k) {
      const double x_m = uniform(-4.0, 24.0), y_m = uniform(-15.0, 3.0);
      p.landmarks.push_back(
          test::landmark(900 + k, detection::Label::kObject, x_m, y_m, uniform(0.05, 2.0)));
    }
    for (const NavigationEdge& way : navigation_graph(p.landmarks, p.rows).edges) {
      ++num_ways;
      for (const Landmark& l : p.landmarks) {
        EXPECT_GE(border_to_way_m(l, way), 0.5 * way.width_m - 1e-6) << "seed " << seed;
        EXPECT_GE(border_to_way_m(l, way), 0.3) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(num_ways, 60) << "of 140: most are free somewhere";
}

TEST(NavigationGraph, AWayThatNobodySawFreeIsNone) {
  const Planted p = plant({0.0, -4.0, -8.0}, 11);
  // a wall that is no landmark closes the first aisle; the second was seen over 1.6 m of its width
  const auto seen = [](const Vector2d& q) {
    if (q.y() > -4.0) return std::abs(q.x() - 9.0) > 0.5;
    return std::abs(q.y() + 6.5) < 0.8;
  };
  const NavigationGraph graph = navigation_graph(p.landmarks, p.rows, seen);
  ASSERT_EQ(graph.edges.size(), 1u);
  EXPECT_EQ(graph.edges[0].row_left, 2);
  EXPECT_NEAR(graph.edges[0].width_m, 1.6, 0.15);
  for (const Vector2d& q : graph.edges[0].line_map) EXPECT_NEAR(q.y(), -6.5, 0.15);
  EXPECT_TRUE(
      navigation_graph(p.landmarks, p.rows, [](const Vector2d&) { return false; }).edges.empty());
}

TEST(NavigationGraph, CurvedRowsAndBlocksApart) {
  const Planted curved = plant({0.0, -4.0, -8.0}, 16, 60.0);
  ASSERT_EQ(curved.rows.size(), 3u);
  const NavigationGraph graph = navigation_graph(curved.landmarks, curved.rows);
  ASSERT_EQ(graph.edges.size(), 2u + 2u);
  for (const Vector2d& point : graph.edges[0].line_map) {
    const double radius_m = (point - Vector2d(0.0, 60.0)).norm();
    EXPECT_NEAR(radius_m, 62.0, 0.12) << "midway between rows of radius 60 and 64";
  }
  // two pairs of rows 14 m apart are two blocks
  const Planted apart = plant({0.0, -4.0, -18.0, -22.0}, 11);
  const NavigationGraph two = navigation_graph(apart.landmarks, apart.rows);
  EXPECT_EQ(std::count_if(two.edges.begin(), two.edges.end(),
                          [](const NavigationEdge& e) { return e.kind == EdgeKind::kAisle; }),
            2);
  EXPECT_TRUE(navigation_graph({}, {}).edges.empty());
  EXPECT_TRUE(navigation_graph(apart.landmarks, {apart.rows[0]}).edges.empty());
}

TEST(NavigationGraph, AShortRowBetweenLongOnesIsGoneRound) {
  Planted p = plant({0.0, -4.0, -8.0}, 11);
  // the middle row keeps its first six places only
  const double end_x_m = 8.0;
  Row& middle = p.rows[1];
  middle.places.erase(std::remove_if(middle.places.begin(), middle.places.end(),
                                     [&](const RowSlot& q) { return q.p_map.x() > end_x_m; }),
                      middle.places.end());
  const NavigationGraph graph = navigation_graph(p.landmarks, p.rows);
  for (const NavigationEdge& edge : graph.edges) {
    if (edge.kind != EdgeKind::kHeadland) continue;
    for (const Vector2d& q : edge.line_map) {
      EXPECT_TRUE(q.x() < -0.5 || q.x() > end_x_m + 0.5) << "not through the row";
    }
  }
}

TEST(RowSpacing, CountsOnlyNeighbours) {
  const Planted p = plant({0.0, -4.0, -8.0}, 11);
  const RowSpacing spacing = row_spacing(p.rows[1]);  // the one with a gap
  EXPECT_NEAR(spacing.median_m, 2.0, 1e-9);
  EXPECT_NEAR(spacing.most_m, 2.0, 1e-9) << "the step over the gap is none";
  EXPECT_NEAR(spacing.sd_m, 0.0, 1e-9);
  EXPECT_EQ(row_spacing(Row{}).median_m, 0.0);
}

Landmark tree(std::int32_t id, double x_m, double y_m, std::int32_t row, std::int32_t position) {
  Landmark l = test::tree(id, x_m, y_m, 0.1, 9);
  l.row = row;
  l.position = position;
  return l;
}

const auto kAdded = [](const Landmark& l) { return l.id >= 100; };

/// Row 4 along x from number 3, trees 2 m apart, 6 and 7 missing.
std::vector<Landmark> row_with_gap() {
  return {tree(1, 0, 0, 4, 3), tree(2, 2, 0, 4, 4), tree(3, 4, 0, 4, 5), tree(4, 10, 0, 4, 8)};
}

TEST(NumberedRows, FollowFromNumbersAndPlaces) {
  std::vector<Landmark> landmarks = row_with_gap();
  landmarks.push_back(tree(5, 0, 5, 0, 0));
  landmarks.push_back(tree(6, 4, 5, 2, 1));
  landmarks[0].row = 4;
  const std::vector<Row> rows = numbered_rows(landmarks);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].number, 2);
  const Row& row = rows[1];
  EXPECT_DOUBLE_EQ(row.spacing_m, 2.0);
  ASSERT_EQ(row.places.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(row.places[i].position, 3 + static_cast<int>(i));
  EXPECT_EQ(row.places[3].landmark_id, 0);
  EXPECT_TRUE(row.places[3].p_map.isApprox(Vector2d(6, 0)));
  EXPECT_TRUE(row.places[4].p_map.isApprox(Vector2d(8, 0)));
}

TEST(NumberedRows, ATreeWithoutAPositionStandsWhereItStands) {
  std::vector<Landmark> landmarks = row_with_gap();
  landmarks.push_back(tree(7, 3, 0.2, 4, 0));
  landmarks.push_back(tree(8, -1, 0, 4, 0));
  landmarks.push_back(tree(9, 12, 0, 4, 0));
  const Row row = numbered_rows(landmarks).at(0);
  std::vector<std::int32_t> ids;
  for (const RowSlot& slot : row.places) ids.push_back(slot.landmark_id);
  EXPECT_EQ(ids, (std::vector<std::int32_t>{8, 1, 2, 7, 3, 0, 0, 4, 9}));
  EXPECT_DOUBLE_EQ(row.spacing_m, 2.0) << "it is no slot";
}

TEST(NumberedRows, NumbersFromOutsideCannotFillTheMemory) {
  const std::vector<Row> rows =
      numbered_rows({tree(1, 0, 0, 1, 1), tree(2, 2, 0, 1, 2'000'000'000)});
  EXPECT_LE(rows.at(0).places.size(), static_cast<std::size_t>(kSlotsMax) + 2);
}

TEST(NumberedRows, AnAddedTreeTakesTheSlotItStandsIn) {
  std::vector<Landmark> landmarks = row_with_gap();
  landmarks.push_back(tree(100, 6.3, 0.2, 0, 0));   // in the gap
  landmarks.push_back(tree(101, 12.1, 0, 0, 0));    // beyond the end
  landmarks.push_back(tree(102, -4.0, 0.1, 0, 0));  // two before the start
  landmarks.push_back(tree(103, 2.4, 0.6, 0, 0));   // where one stands already
  landmarks.push_back(tree(104, 6.0, 3.0, 0, 0));   // beside no row
  landmarks.push_back(tree(5, 8.0, 0, 0, 0));       // not added: the run left it out of the row
  number_added_trees(landmarks, kAdded);
  const auto number = [&](std::size_t i) {
    return std::pair(landmarks[4 + i].row, landmarks[4 + i].position);
  };
  EXPECT_EQ(number(0), std::pair(4, 6));
  EXPECT_EQ(number(1), std::pair(4, 9));
  EXPECT_EQ(number(2), std::pair(4, 1));
  EXPECT_EQ(number(3), std::pair(4, 0));
  EXPECT_EQ(number(4), std::pair(0, 0));
  EXPECT_EQ(number(5), std::pair(0, 0));
}

TEST(NumberedRows, NumbersBelowOneAreNotGiven) {
  std::vector<Landmark> landmarks{tree(1, 0, 0, 1, 1), tree(2, 2, 0, 1, 2), tree(100, -2, 0, 0, 0)};
  number_added_trees(landmarks, kAdded);
  EXPECT_EQ(landmarks[2].row, 0);
}

TEST(Narrowed, AnObstacleChangesOnlyTheWaysBesideIt) {
  NavigationGraph graph;
  graph.nodes = {{1, {0, 0}}, {2, {20, 0}}, {3, {0, 5}}, {4, {20, 5}}, {5, {0, 10}}, {6, {20, 10}}};
  for (int k = 0; k < 3; ++k) {
    NavigationEdge edge;
    edge.id = k + 1;
    edge.from = 2 * k + 1;
    edge.to = 2 * k + 2;
    edge.width_m = 3.0;
    edge.line_map = {{0, 5.0 * k}, {20, 5.0 * k}};
    graph.edges.push_back(edge);
  }
  const NavigationGraph now = narrowed(graph, {tree(1, 10, 1.0, 0, 0), tree(2, 10, 5.2, 0, 0)});
  ASSERT_EQ(now.edges.size(), 2u);
  EXPECT_EQ(now.edges[0].id, 1);
  EXPECT_NEAR(now.edges[0].width_m, 2.0 * (1.0 - 0.05), 1e-9);
  EXPECT_EQ(now.edges[1].id, 3);
  EXPECT_EQ(now.edges[1].width_m, 3.0);
  EXPECT_EQ(now.nodes.size(), 4u);
  EXPECT_EQ(narrowed(graph, {}).edges.size(), 3u);
}

}  // namespace

}  // namespace orchard::mapping
