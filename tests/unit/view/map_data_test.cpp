// SPDX-License-Identifier: BSD-3-Clause
#include "view/map_data.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace orchard::view {
namespace {

using nlohmann::json;

mapping::Landmark make_landmark(std::int32_t id, detection::Label label, double x_m, double y_m) {
  mapping::Landmark l;
  l.id = id;
  l.label = label;
  l.num_observations = 7;
  l.x_m = x_m;
  l.y_m = y_m;
  l.se_x_m = 0.0049;
  l.se_y_m = 0.0051;
  l.width_m = 0.123;
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

}  // namespace
}  // namespace orchard::view
