// SPDX-License-Identifier: BSD-3-Clause
#include "view/map_tiles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

namespace orchard::view {
namespace {

using nlohmann::json;

/// A map of trees at random places, a row with an empty place in each second one, one way and one
/// path from corner to corner.
struct TiledMap {
  explicit TiledMap(int num_trees) {
    std::mt19937 dice(3);
    std::uniform_real_distribution<double> place_m(-900.0, 900.0);
    for (int k = 0; k < num_trees; ++k) {
      mapping::Landmark l;
      l.id = 2 * k + 1;
      l.label = k % 10 == 0 ? detection::Label::kObject : detection::Label::kTree;
      l.x_m = place_m(dice);
      l.y_m = place_m(dice);
      landmarks.push_back(l);
    }
    mapping::Row row;
    row.number = 7;
    for (int k = 0; k < 400; ++k) {
      row.places.push_back({k + 1, k % 2 == 0 ? 2 * k + 1 : 0, {4.0 * k - 800.0, 3.0}});
      if (k % 2 == 0) landmarks[static_cast<std::size_t>(k)].x_m = 4.0 * k - 800.0;
      if (k % 2 == 0) landmarks[static_cast<std::size_t>(k)].y_m = 3.0;
    }
    rows.push_back(row);
    graph.edges.emplace_back();
    graph.edges.back().line_map = {{-850, -700}, {850, 700}};
    for (const double at_m : {-800.0, 0.0, 800.0}) {
      path.emplace_back();
      path.back().x_m = at_m;
      path.back().y_m = 0.3 * std::abs(at_m);
    }
    data.landmarks = &landmarks;
    data.rows = &rows;
    data.graph = &graph;
    data.paths = {&path};
  }

  std::vector<mapping::Landmark> landmarks;
  std::vector<mapping::Row> rows;
  mapping::NavigationGraph graph;
  std::vector<pose::PoseEstimate> path;
  MapData data;
};

double length_m(const json& line) {
  double sum_m = 0.0;
  for (std::size_t k = 2; k + 1 < line.size(); k += 2) {
    sum_m += std::hypot(line[k].get<double>() - line[k - 2].get<double>(),
                        line[k + 1].get<double>() - line[k - 1].get<double>());
  }
  return sum_m;
}

TEST(MapTiles, TogetherTheyAreTheMap) {
  const TiledMap map(40000);
  const MapTiles tiles(map.data);
  const json overview = json::parse(tiles.overview_json());
  const json index = json::parse(tiles.index_json());
  const auto names = tiles.names();
  ASSERT_GT(names.size(), 4u);
  EXPECT_EQ(overview["tiles"]["counts"], json({36000, 4000, 0}));
  EXPECT_EQ(overview["tiles"]["places"].size(), 3 * names.size());
  EXPECT_TRUE(overview["landmarks"].empty());

  std::map<int, std::size_t> tile_of_id;
  std::size_t num_gaps = 0;
  double row_m = 0.0, way_m = 0.0, path_m = 0.0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const json tile = json::parse(tiles.tile_json(names[k]).value());
    EXPECT_EQ(tile["stamp"], overview["tiles"]["stamp"]);
    const auto& ids = tile["landmarks"]["id"];
    EXPECT_LE(ids.size(), 8000u);
    EXPECT_EQ(ids.size(), overview["tiles"]["places"][3 * k + 2].get<std::size_t>());
    const double left_m = overview["tiles"]["places"][3 * k].get<double>() * tiles.side_m();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      EXPECT_TRUE(tile_of_id.emplace(ids[i].get<int>(), k).second) << "in two tiles";
      const double x_m = tile["landmarks"]["x"][i].get<double>();
      EXPECT_GE(x_m, left_m - 0.001);
      EXPECT_LE(x_m, left_m + tiles.side_m() + 0.001);
    }
    num_gaps += tile["gaps"].size();
    for (const json& line : tile["rows"]) row_m += length_m(line);
    for (const json& way : tile["ways"]) way_m += length_m(way["line"]);
    for (const json& line : tile["paths"]) path_m += length_m(line);
  }
  EXPECT_EQ(tile_of_id.size(), map.landmarks.size());
  EXPECT_EQ(num_gaps, 200u);
  // Cut lines are as long as whole ones; coordinates are in whole millimetres.
  EXPECT_NEAR(row_m, 4.0 * 398, 0.1);
  EXPECT_NEAR(way_m, std::hypot(1700.0, 1400.0), 0.1);
  EXPECT_NEAR(path_m, 2.0 * std::hypot(800.0, 240.0), 0.1);

  // The index names the tile of every id.
  std::size_t run = 0;
  const json& runs = index["ids"];
  for (const auto& [id, tile] : tile_of_id) {
    while (2 * run + 2 < runs.size() && runs[2 * run + 2].get<int>() <= id) ++run;
    ASSERT_EQ(runs[2 * run + 1].get<std::size_t>(), tile) << "id " << id;
  }
  EXPECT_EQ(index["rows"]["7"][0], 1);
}

TEST(MapTiles, TheSmallestTileBoundsHowManyThereAre) {
  TiledMap map(30000);
  for (mapping::Landmark& l : map.landmarks) l.x_m = l.y_m = 1.0;  // all at one place
  const MapTiles tiles(map.data);
  EXPECT_EQ(tiles.side_m(), 32.0);
  EXPECT_TRUE(tiles.tile_json("0_0").has_value());
  EXPECT_FALSE(tiles.tile_json("../0_0").has_value());
  EXPECT_EQ(tiles.overview_parts_json().find('\n'), std::string::npos) << "an event is one line";
}

TEST(MapTiles, AnotherMapHasAnotherStamp) {
  TiledMap map(500);
  const auto stamp = [&map] {
    return json::parse(MapTiles(map.data).overview_json())["tiles"]["stamp"].get<std::string>();
  };
  const std::string before = stamp();
  EXPECT_EQ(stamp(), before);
  map.landmarks[17].x_m += 0.001;
  EXPECT_NE(stamp(), before);
}

}  // namespace
}  // namespace orchard::view
