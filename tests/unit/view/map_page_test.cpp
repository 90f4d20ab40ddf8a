// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>

#include "view/map_data.hpp"
#include "view/map_tiles.hpp"
#include "view/page.hpp"
#include "worlds/landmark.hpp"

namespace orchard::view {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;

mapping::Landmark make_landmark(std::int32_t id, detection::Label label, double x_m, double y_m) {
  mapping::Landmark l = test::landmark(id, label, x_m, y_m, 0.123, 7);
  l.se_x_m = 0.0049;
  l.se_y_m = 0.0051;
  l.width_sd_m = 0.004;
  l.roc_mean = 0.87;
  l.probability = 0.9991;
  l.row = 2;
  l.position = 3;
  return l;
}

TEST(MapData, HasEveryLandmarkInColumns) {
  using detection::Label;
  const std::vector<mapping::Landmark> landmarks{make_landmark(4, Label::kTree, 1.2345, -0.0001),
                                                 make_landmark(9, Label::kObject, -3.5, 2.0),
                                                 make_landmark(12, Label::kUnseen, 0.0, 1e4)};
  mapping::Row row;
  row.number = 2;
  row.spacing_m = 1.5;
  row.places = {{1, 4, {0, 0}}, {2, 0, {0, 1.5}}, {3, 9, {0, 3}}};
  const std::vector<mapping::Row> rows{row};
  mapping::NavigationGraph graph;
  graph.edges.emplace_back();
  graph.edges.back().width_m = 2.25;
  graph.edges.back().line_map = {{1, 2}, {3, 4}};
  std::vector<pose::PoseEstimate> path(3);
  path[1].x_m = 1.0;
  path[2].x_m = 2.0;
  MapData map_data;
  map_data.title = "</script>\xFF\"\\\n";
  map_data.last_utime = 1385942400000000;
  map_data.warnings = {"<b>"};
  map_data.landmarks = &landmarks;
  map_data.rows = &rows;
  map_data.graph = &graph;
  map_data.paths = {&path};

  const json read = json::parse(map_data_json(map_data));
  EXPECT_EQ(read["title"], "</script>\xEF\xBF\xBD\"\\\n") << "bytes that are no text are replaced";
  EXPECT_EQ(read["last_utime"], 1385942400000000);
  const json& columns = read["landmarks"];
  EXPECT_EQ(columns["id"], json({4, 9, 12}));
  EXPECT_EQ(columns["label"], json({0, 1, 2}));
  EXPECT_NEAR(columns["x"][0].get<double>(), 1.2345, 0.0006);
  EXPECT_EQ(columns["y"][2], 1e4);
  EXPECT_NEAR(columns["width_sd"][1].get<double>(), 0.004, 1e-4);
  EXPECT_EQ(columns["position"], json({3, 3, 3}));
  EXPECT_NEAR(columns["width"][1].get<double>(), 0.123, 1e-4);
  for (const auto& [name, column] : columns.items()) EXPECT_EQ(column.size(), 3u) << name;
  EXPECT_FALSE(columns.contains("length")) << "nothing is longer than wide";
  EXPECT_FALSE(columns.contains("latitude")) << "its place on the earth is not known";
  EXPECT_FALSE(columns.contains("z")) << "no height is known";
  EXPECT_EQ(read["rows"][0]["line"], json({0.0, 0.0, 0.0, 3.0}));
  EXPECT_EQ(read["rows"][0]["gaps"], json::parse("[[2, 0.0, 1.5]]"));
  EXPECT_EQ(read["ways"][0]["line"], json({1.0, 2.0, 3.0, 4.0}));
  EXPECT_EQ(read["paths"][0], json({0.0, 0.0, 2.0, 0.0})) << "the straight path's two ends";

  std::vector<mapping::Landmark> with_hedge = landmarks;
  with_hedge[1].length_m = 7.5;
  with_hedge[1].direction_rad = -0.25;
  map_data.landmarks = &with_hedge;
  const json hedge = json::parse(map_data_json(map_data))["landmarks"];
  EXPECT_EQ(hedge["length"], json({0.0, 7.5, 0.0}));
  EXPECT_EQ(hedge["direction"], json({0.0, -0.25, 0.0}));
  map_data.landmarks = &landmarks;

  map_data.georeference = geometry::Georeference{-27.6, 151.9, 500.0, 0.0, 0.0, 0.0, 0.05};
  const json placed = json::parse(map_data_json(map_data));
  // A degree of latitude is 110.6 to 111.7 km.
  EXPECT_NEAR(placed["landmarks"]["latitude"][2].get<double>(), -27.6 + 1e4 / 111e3, 0.001);
  EXPECT_EQ(map_data_json(map_data), map_data_json(map_data));
}

TEST(MapData, AnEmptyMapIsAMap) {
  const std::vector<mapping::Landmark> landmarks;
  const std::vector<mapping::Row> rows;
  const mapping::NavigationGraph graph;
  MapData map_data;
  map_data.landmarks = &landmarks;
  map_data.rows = &rows;
  map_data.graph = &graph;
  const json read = json::parse(map_data_json(map_data));
  EXPECT_TRUE(read["landmarks"]["id"].empty());
  EXPECT_TRUE(read["paths"].empty());
}

/// A map of trees at random places, a row with an empty place in each second one, one way and one
/// path from corner to corner.
struct TiledMap {
  explicit TiledMap(int num_trees) {
    std::mt19937 dice(3);
    std::uniform_real_distribution<double> place_m(-900.0, 900.0);
    for (int k = 0; k < num_trees; ++k) {
      const auto label = k % 10 == 0 ? detection::Label::kObject : detection::Label::kTree;
      const double x_m = place_m(dice), y_m = place_m(dice);
      landmarks.push_back(test::landmark(2 * k + 1, label, x_m, y_m));
    }
    mapping::Row row;
    row.number = 7;
    for (int k = 0; k < 400; ++k) {
      row.places.push_back({k + 1, k % 2 == 0 ? 2 * k + 1 : 0, {4.0 * k - 800.0, 3.0}});
      if (k % 2 != 0) continue;
      mapping::Landmark& l = landmarks[static_cast<std::size_t>(k)];
      l.x_m = 4.0 * k - 800.0;
      l.y_m = 3.0;
      l.row = row.number;
      l.position = k + 1;
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
  EXPECT_EQ(overview["tiles"]["counts"], json({160, 4000, 0, 35840}))
      << "trees in rows, objects, unseen, other trunks";
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

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t number = 0;
  for (auto at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++number;
  return number;
}

TEST(Page, NothingFromOutsideIsMarkup) {
  const std::string html =
      page_html("</title><script>alert(1)</script>",
                R"({"title": "</script><script>alert(2)</script> {{SCRIPT}}"})", PageSource::kFile);
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(count(html, "</script>"), 2u) << "the data's and the script's own";
  EXPECT_EQ(count(html, "</title>"), 1u);
  EXPECT_THAT(html, HasSubstr("{{SCRIPT}}")) << "data is put in as it is, once";
}

TEST(Page, AsksNobodyForAnything) {
  const std::string html = page_html("map", "{}", PageSource::kFile);
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page_policy(PageSource::kFile), Not(HasSubstr("connect-src")));
  EXPECT_THAT(page_policy(PageSource::kFile), Not(HasSubstr("unsafe")));
  EXPECT_THAT(page_policy(PageSource::kServer), HasSubstr("connect-src 'self'"));
  for (const char* outside :
       {"src=\"http", "href=\"http", "url(", "@import", "onclick=", "onload="}) {
    EXPECT_THAT(html, Not(HasSubstr(outside)));
  }
}

}  // namespace
}  // namespace orchard::view
