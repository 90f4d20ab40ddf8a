// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_numbers.hpp"

#include <gtest/gtest.h>

#include "mapping/rows/navigation_graph.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

Landmark tree(std::int32_t id, double x_m, double y_m, std::int32_t row, std::int32_t position) {
  Landmark l;
  l.id = id;
  l.label = detection::Label::kTree;
  l.num_observations = 9;
  l.width_m = 0.1;
  l.x_m = x_m;
  l.y_m = y_m;
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
