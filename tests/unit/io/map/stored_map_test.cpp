// SPDX-License-Identifier: BSD-3-Clause
#include "io/map/stored_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <GeographicLib/LocalCartesian.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <tuple>

#include "io/file_error.hpp"
#include "io/map/corrected_map.hpp"
#include "io/map/map_folder.hpp"
#include "unit/io/test_folder.hpp"
#include "worlds/landmark.hpp"

namespace orchard::io {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const char kHeader[] =
    "id,class,x_m,y_m,n,roc_mean,probability,se_x_m,se_y_m,width_m,row,position\n";

/// What reading a map.csv of these lines says; empty when it reads.
std::string refusal(const std::string& lines) {
  const TestFolder folder;
  const std::string path = folder.file("map.csv", kHeader + lines);
  return refusal_of([&] { read_stored_map(path); });
}

std::string line(int id, double x, double y, double width) {
  return std::to_string(id) + ",tree," + std::to_string(x) + "," + std::to_string(y) +
         ",5,0.9,0.9,0.01,0.01," + std::to_string(width) + ",,\n";
}

TEST(StoredMap, RefusesWhatIsNoMapInMetres) {
  std::string metres, millimetres, degrees;
  for (int i = 0; i < 8; ++i) {
    metres += line(i + 1, 2.0 * i, 0.1 * i, 0.12);
    millimetres += line(i + 1, 2000.0 * i, 100.0 * i, 120.0);
    degrees += line(i + 1, 151.93 + 2e-5 * i, -27.6 + 1e-6 * i, 0.12);
  }
  EXPECT_EQ(refusal(metres), "");
  EXPECT_THAT(refusal(millimetres), HasSubstr("map.csv:2: width_m = 120.0"));
  EXPECT_THAT(refusal(millimetres), HasSubstr("millimetres"));
  EXPECT_THAT(refusal(degrees), HasSubstr("map.csv:2: "));
  EXPECT_THAT(refusal(degrees), HasSubstr("degrees"));
  std::string far;  // widths are right, places are not
  for (int i = 0; i < 8; ++i) far += line(i + 1, 2000.0 * i, 100.0 * i, 0.12);
  EXPECT_THAT(refusal(far), HasSubstr("millimetres"));
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal(metres + line(3, 50, 1, 0.1)), HasSubstr("map.csv:10:1: id: this id"));
  EXPECT_THAT(refusal("1,tree,nan,0,5,0.9,0.9,0.01,0.01,0.1,,\n"), HasSubstr("map.csv:2:"));
  EXPECT_THAT(refusal("1,tree,0,0,5,0.9,0.9,0.01,0.01,inf,,\n"), HasSubstr("map.csv:2:"));
  EXPECT_EQ(refusal(line(1, 0, 0, 0.1)), "") << "one tree is a map";
  const TestFolder folder;
  EXPECT_THROW(read_stored_map(folder.path()), FileError) << "no map.csv";
  EXPECT_THROW(read_stored_map(folder / "none.csv"), FileError);
}

MapFolderContent content_with_rows() {
  MapFolderContent content;
  for (int i = 0; i < 40; ++i) {
    content.landmarks.push_back(test::tree(i + 1, 2.0 * (i % 10), 4.0 * (i / 10), 0.1, 5));
  }
  content.rows = mapping::find_rows(content.landmarks, mapping::RowsConfig{});
  mapping::number_landmarks(content.rows, content.landmarks);
  content.graph = mapping::navigation_graph(content.landmarks, content.rows);
  for (int i = 0; i < 20; ++i) {
    pose::PoseEstimate p;
    p.utime = 1000 + i;
    p.x_m = i;
    content.trajectory.push_back(p);
  }
  return content;
}

TEST(StoredMap, ReadsBackWhatAFolderSays) {
  const TestFolder folder;
  MapFolderContent content = content_with_rows();
  mapping::SensorView view;
  view.reach_m = 5.5;
  view.bearing_min_rad = -2.0;
  view.bearing_max_rad = 1.5;
  view.mount_x_m = 0.35;
  view.min_observations = 5;
  content.view = view;
  content.next_id = 77;
  content.georeference = geometry::Georeference{-27.604, 151.932, 690.0, 10.0, -3.0, 0.4, 0.12};
  content.more_trajectories = {content.trajectory};
  write_map_folder(folder.path(), content);
  const StoredMap map = read_stored_map(folder.path());
  EXPECT_EQ(map.landmarks.size(), 40u);
  EXPECT_EQ(map.trajectories.size(), 2u);
  EXPECT_EQ(map.next_id, 77);
  EXPECT_NEAR(map.view.reach_m, 5.5, 1e-9);
  EXPECT_NEAR(map.view.bearing_min_rad, -2.0, 1e-6);
  EXPECT_NEAR(map.view.mount_x_m, 0.35, 1e-9);
  EXPECT_EQ(map.view.min_observations, 5);
  ASSERT_TRUE(map.georeference.has_value());
  EXPECT_NEAR(map.georeference->latitude_deg, -27.604, 1e-9);
  EXPECT_NEAR(map.georeference->yaw_rad, 0.4, 1e-9);
  ASSERT_EQ(map.graph.edges.size(), content.graph.edges.size());
  EXPECT_EQ(map.graph.nodes.size(), content.graph.nodes.size());
  for (std::size_t i = 0; i < map.graph.edges.size(); ++i) {
    const mapping::NavigationEdge &now = map.graph.edges[i], &was = content.graph.edges[i];
    EXPECT_EQ(std::tie(now.id, now.kind, now.from, now.to, now.row_left, now.row_right),
              std::tie(was.id, was.kind, was.from, was.to, was.row_left, was.row_right));
    EXPECT_NEAR(now.width_m, was.width_m, 5e-4);
    ASSERT_EQ(now.line_map.size(), was.line_map.size());
    EXPECT_LT((now.line_map.back() - was.line_map.back()).norm(), 1e-3);
  }
  const StoredMap alone = read_stored_map(folder / "map.csv");
  EXPECT_TRUE(alone.graph.edges.empty());
  EXPECT_TRUE(alone.trajectories.empty());
  EXPECT_EQ(alone.next_id, 41);
  std::ofstream(folder / "summary.json") << "{\"view\": {\"reach_m\": \"far\"}}";
  EXPECT_THROW(read_stored_map(folder.path()), FileError);
  std::ofstream(folder / "summary.json") << "[1, 2";
  EXPECT_THROW(read_stored_map(folder.path()), FileError);
}

TEST(StoredMap, RefusesAGraphThatCannotBe) {
  const TestFolder folder;
  write_map_folder(folder.path(), content_with_rows());
  const std::string node = R"({"id": 1, "place": [0, 0]})";
  const auto edge = [](const std::string& more) {
    return R"([{"id": 1, "kind": "headland", "from": 1, "to": 1, "row": 1, "length_m": 2, )" +
           more + "}]";
  };
  const std::string good = R"("width_m": 1, "line": [[0, 0], [0, 0]])";
  const auto graph = [&](const std::string& nodes, const std::string& edges) {
    std::ofstream(folder / "graph.json")
        << R"({"nodes": [)" + nodes + R"(], "edges": )" + edges + "}";
    return read_stored_map(folder.path()).graph.edges.size();
  };
  EXPECT_EQ(graph(node, edge(good)), 1u);
  EXPECT_THROW(graph(node + "," + node, edge(good)), FileError) << "an id twice";
  EXPECT_THROW(graph("", edge(good)), FileError) << "no such node";
  EXPECT_THROW(graph(node, edge(R"("width_m": -1, "line": [[0, 0], [0, 0]])")), FileError);
  EXPECT_THROW(graph(node, edge(R"("width_m": 1, "line": [[0, 1e300], [0, 0]])")), FileError);
  EXPECT_THROW(graph(node, edge(R"("width_m": 1, "line": [[0], [0, 0]])")), FileError);
  EXPECT_THROW(graph(node, edge(R"("width_m": 1, "line": [])")), FileError);
  EXPECT_THROW(graph(node, "7"), FileError);
  std::ofstream(folder / "graph.json") << "[";
  EXPECT_THROW(read_stored_map(folder.path()), FileError);
}

mapping::Correction correction(mapping::CorrectionKind kind, const mapping::Landmark* target) {
  mapping::Correction c;
  c.number = 1;
  c.kind = kind;
  if (target)
    c.targets = {{target->id, {target->x_m, target->y_m}, target->label, target->width_m}};
  return c;
}

TEST(CorrectedMap, ACorrectionChangesOnlyWhatItTouches) {
  const TestFolder folder;
  write_map_folder(folder.path(), content_with_rows());
  const StoredMap stored = read_stored_map(folder.path());
  const CorrectedMapFolder before = corrected_map_of(stored, {});
  ASSERT_EQ(before.rows.size(), 4u);
  ASSERT_EQ(before.graph.edges.size(), stored.graph.edges.size());
  const auto same_row = [](const mapping::Row& a, const mapping::Row& b) {
    bool same = a.places.size() == b.places.size() && a.spacing_m == b.spacing_m;
    for (std::size_t i = 0; same && i < a.places.size(); ++i) {
      same = a.places[i].landmark_id == b.places[i].landmark_id &&
             a.places[i].position == b.places[i].position && a.places[i].p_map == b.places[i].p_map;
    }
    return same;
  };
  const mapping::Landmark& felled = stored.landmarks.at(14);  // inside of a row
  const CorrectedMapFolder without =
      corrected_map_of(stored, {correction(mapping::CorrectionKind::kDelete, &felled)});
  int num_changed = 0;
  for (std::size_t r = 0; r < 4; ++r) num_changed += !same_row(before.rows[r], without.rows[r]);
  EXPECT_EQ(num_changed, 1);
  const mapping::Row& row = without.rows.at(static_cast<std::size_t>(felled.row) - 1);
  EXPECT_EQ(std::count_if(row.places.begin(), row.places.end(),
                          [](const auto& slot) { return slot.landmark_id == 0; }),
            1);
  for (std::size_t i = 0; i < before.graph.edges.size(); ++i) {
    EXPECT_EQ(without.graph.edges.at(i).width_m, before.graph.edges[i].width_m);
  }
  // a post beside an aisle's line narrows this aisle alone
  mapping::Correction post = correction(mapping::CorrectionKind::kAdd, nullptr);
  const mapping::NavigationEdge& aisle = before.graph.edges.front();
  post.places_map = {aisle.line_map.at(aisle.line_map.size() / 2) + Eigen::Vector2d(0.0, 0.8)};
  post.label = detection::Label::kObject;
  post.new_id = 99;
  const CorrectedMapFolder with = corrected_map_of(stored, {post});
  EXPECT_LT(with.graph.edges.at(0).width_m, before.graph.edges[0].width_m);
  for (std::size_t i = 1; i < before.graph.edges.size(); ++i) {
    EXPECT_EQ(with.graph.edges.at(i).width_m, before.graph.edges[i].width_m);
  }
}

std::unique_ptr<GDALDataset> open(const std::string& path) {
  GDALAllRegister();
  return std::unique_ptr<GDALDataset>(
      GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
}

TEST(MapGeopackage, GeoreferencedMapsLieWhereTheyStandOnTheEarth) {
  for (const double latitude_deg : {-27.604, 0.0001, 51.2}) {
    const TestFolder folder;
    MapFolderContent content = content_with_rows();
    const geometry::Georeference g{latitude_deg, 151.932, 690.0, 10.0, -3.0, 0.4, 0.02};
    content.georeference = g;
    write_map_folder(folder.path(), content);
    const auto dataset = open(folder / "map.gpkg");
    ASSERT_NE(dataset, nullptr);
    OGRLayer* layer = dataset->GetLayerByName("landmarks");
    ASSERT_NE(layer, nullptr);
    OGRSpatialReference* utm = layer->GetSpatialRef();
    ASSERT_NE(utm, nullptr);
    EXPECT_STREQ(utm->GetAuthorityCode(nullptr), latitude_deg < 0 ? "32756" : "32656");
    // back to latitude and longitude by PROJ, and there by GeographicLib: two roads to one place
    OGRSpatialReference wgs84;
    wgs84.importFromEPSG(4326);
    wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    const std::unique_ptr<OGRCoordinateTransformation> to_degrees(
        OGRCreateCoordinateTransformation(utm, &wgs84));
    const GeographicLib::LocalCartesian enu(latitude_deg, 151.932, 690.0);
    for (const auto& feature : *layer) {
      const mapping::Landmark& l =
          content.landmarks[static_cast<std::size_t>(feature->GetFieldAsInteger("id")) - 1];
      double latitude, longitude, altitude;
      enu.Reverse(std::cos(0.4) * l.x_m - std::sin(0.4) * l.y_m + 10.0,
                  std::sin(0.4) * l.x_m + std::cos(0.4) * l.y_m - 3.0, 0.0, latitude, longitude,
                  altitude);
      double x = feature->GetGeometryRef()->toPoint()->getX();
      double y = feature->GetGeometryRef()->toPoint()->getY();
      ASSERT_TRUE(to_degrees->Transform(1, &x, &y));
      EXPECT_NEAR(x, longitude, 1e-8);  // a millimetre
      EXPECT_NEAR(y, latitude, 1e-8);
      EXPECT_NEAR(feature->GetFieldAsDouble("latitude_deg"), latitude, 0.51e-9) << "0.1 mm";
      EXPECT_EQ(feature->GetFieldAsDouble("x_m"), l.x_m) << "map coordinates stay";
    }
  }
}

TEST(MapGeopackage, HoldsWaysAndRowsAsLayers) {
  const TestFolder folder;
  write_map_folder(folder.path(), content_with_rows());
  const auto dataset = open(folder / "map.gpkg");
  ASSERT_NE(dataset, nullptr);
  for (const auto& [name, count] : std::vector<std::pair<const char*, int>>{{"landmarks", 40},
                                                                            {"rows", 4},
                                                                            {"gaps", 0},
                                                                            {"aisles", 3},
                                                                            {"headlands", 4},
                                                                            {"nodes", 6},
                                                                            {"path", 1}}) {
    OGRLayer* layer = dataset->GetLayerByName(name);
    ASSERT_NE(layer, nullptr) << name;
    EXPECT_EQ(layer->GetFeatureCount(), count) << name;
  }
  const std::unique_ptr<OGRFeature> aisle(dataset->GetLayerByName("aisles")->GetNextFeature());
  EXPECT_NEAR(aisle->GetFieldAsDouble("width_m"), 3.9, 1e-6);
  EXPECT_THAT(read_bytes(folder / "graph.json"), HasSubstr("\"kind\": \"aisle\""));
}

TEST(Summary, WarnsOfAGeoreferenceThatDoesNotFit) {
  const TestFolder folder;
  MapFolderContent content = content_with_rows();
  content.georeference = geometry::Georeference{50.0, 8.0, 100.0, 0.0, 0.0, 0.0, 0.29};
  write_map_folder(folder.path(), content);
  EXPECT_THAT(read_bytes(folder / "summary.json"), Not(HasSubstr("doubtful")));
  content.georeference->residual_rms_m = 0.84;
  write_map_folder(folder.path(), content);
  EXPECT_THAT(read_bytes(folder / "summary.json"),
              HasSubstr("doubtful: GNSS fixes deviate by 0.84 m"));
}

}  // namespace
}  // namespace orchard::io
