// SPDX-License-Identifier: BSD-3-Clause
#include "io/gis/plan_file.hpp"

#include <fmt/format.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <GeographicLib/Geodesic.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "geometry/georeference.hpp"
#include "io/config/config_file.hpp"
#include "io/file_error.hpp"
#include "io/gis/plan_report.hpp"
#include "io/map/plan_names.hpp"
#include "mapping/plan/orchard_plan.hpp"
#include "unit/io/test_folder.hpp"

namespace orchard::io {
namespace {

namespace fs = std::filesystem;

/// A kind of file that a grower may have, with its extension.
struct PlanKind {
  const char* driver;
  const char* extension;
  const char* crs;  ///< empty: latitude and longitude
  bool needs_crs;   ///< the file cannot say which it has
};
constexpr PlanKind kPlanKinds[] = {
    {"GPKG", "gpkg", "EPSG:3857", false},  {"ESRI Shapefile", "shp", "EPSG:32630", false},
    {"GeoJSON", "geojson", "", false},     {"LIBKML", "kml", "", false},
    {"DXF", "dxf", "EPSG:25830", true},    {"CSV", "csv", "", false},
    {"CSV", "csv", "EPSG:25830", true},    {"FlatGeobuf", "fgb", "EPSG:2154", false},
    {"GPKG", "gpkg", "EPSG:27700", false},
};

void require(bool holds) {
  if (!holds) throw std::runtime_error("a plan for the test could not be written");
}

/// Writes a plan whose frame lies on the earth as `georeference` says, by GDAL's own writers and
/// transformations. A DXF gets a layer for each row and no tree names.
std::string write_plan(const mapping::OrchardPlan& plan, const geometry::Georeference& georeference,
                       const PlanKind& kind, const std::string& stem) {
  GDALAllRegister();
  const std::string path = stem + "." + kind.extension;
  OGRSpatialReference wgs84, srs;
  wgs84.importFromEPSG(4326);
  wgs84.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  srs.SetFromUserInput(*kind.crs ? kind.crs : "EPSG:4326");
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> transformation(
      OGRCreateCoordinateTransformation(&wgs84, &srs));
  const auto place_of = [&](const mapping::PlannedTree& tree) {
    const geometry::Geodetic place = geometry::geodetic_of(georeference, tree.p_plan);
    Eigen::Vector2d p(place.longitude_deg, place.latitude_deg);
    require(transformation->Transform(1, &p.x(), &p.y()));
    return p;
  };
  const std::string driver = kind.driver;
  if (driver == "CSV") {
    std::ofstream file(path);
    file << (*kind.crs ? "Row,Tree,Easting,Northing\n" : "Row,Tree,Longitude,Latitude\n");
    for (const mapping::PlannedRow& row : plan.rows) {
      for (const mapping::PlannedTree& tree : row.trees) {
        const Eigen::Vector2d p = place_of(tree);
        char line[160];
        std::snprintf(line, sizeof line, "%s,%s,%.9f,%.9f\n", row.name.c_str(), tree.name.c_str(),
                      p.x(), p.y());
        file << line;
      }
    }
    return path;
  }
  const GDALDatasetUniquePtr dataset(GetGDALDriverManager()
                                         ->GetDriverByName(kind.driver)
                                         ->Create(path.c_str(), 0, 0, 0, GDT_Unknown, nullptr));
  require(dataset != nullptr);
  OGRLayer* layer = dataset->CreateLayer("trees", &srs, wkbPoint, nullptr);
  require(layer != nullptr);
  const bool is_drawing = driver == "DXF";
  if (!is_drawing) {
    for (const char* name : {"Row", "Tree"}) {
      OGRFieldDefn field(name, OFTString);
      require(layer->CreateField(&field) == OGRERR_NONE);
    }
  }
  for (const mapping::PlannedRow& row : plan.rows) {
    for (const mapping::PlannedTree& tree : row.trees) {
      OGRFeature feature(layer->GetLayerDefn());
      feature.SetField(is_drawing ? "Layer" : "Row", row.name.c_str());
      if (!is_drawing) feature.SetField("Tree", tree.name.c_str());
      const Eigen::Vector2d p = place_of(tree);
      const OGRPoint point(p.x(), p.y());
      feature.SetGeometry(&point);
      require(layer->CreateFeature(&feature) == OGRERR_NONE);
    }
  }
  return path;
}

class PlanFile : public ::testing::Test {
 protected:
  /// What refuses it.
  std::string refusal(const std::string& path, const PlanFileOptions& options = {}) const {
    try {
      return refusal_of([&] { read_plan(path, options); });
    } catch (const ConfigError& error) {
      return error.problems().front();
    }
  }

  TestFolder folder_;
};

geometry::Georeference in_spain() {
  geometry::Georeference g;
  g.latitude_deg = 41.6;
  g.longitude_deg = 0.6;
  g.yaw_rad = 0.7;
  return g;
}

mapping::OrchardPlan small_plan() {
  mapping::OrchardPlan plan;
  for (int r = 0; r < 3; ++r) {
    mapping::PlannedRow row{std::to_string(10 + r), {}};
    for (int k = 0; k < 5; ++k) row.trees.push_back({std::to_string(k + 1), {3.0 * k, 4.5 * r}});
    plan.rows.push_back(row);
  }
  return plan;
}

TEST_F(PlanFile, IsTheSameFromEveryFormatAndSystem) {
  const mapping::OrchardPlan truth = small_plan();
  for (const PlanKind& kind : kPlanKinds) {
    const std::string path = write_plan(truth, in_spain(), kind, folder_ / "plan");
    PlanFileOptions options;
    if (kind.needs_crs) options.crs = kind.crs;
    const StoredPlan plan = read_plan(path, options);
    EXPECT_EQ(plan.crs, *kind.crs ? kind.crs : "EPSG:4326") << path;
    ASSERT_TRUE(plan.georeference) << path;
    ASSERT_EQ(plan.plan.rows.size(), 3u) << path;
    const mapping::OrchardPlan back = plan_in_map(plan, in_spain());
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_EQ(back.rows[r].name, truth.rows[r].name) << path;
      ASSERT_EQ(back.rows[r].trees.size(), 5u) << path;
      for (std::size_t k = 0; k < 5; ++k) {
        EXPECT_EQ(back.rows[r].trees[k].name, truth.rows[r].trees[k].name) << path;
        // a datum of another ellipsoid costs decimetres unless its grid is at hand
        const double most_m = std::string(kind.crs) == "EPSG:27700" ? 5.0 : 0.01;
        EXPECT_LT((back.rows[r].trees[k].p_plan - truth.rows[r].trees[k].p_plan).norm(), most_m)
            << path;
      }
    }
    fs::remove(path);
  }
}

TEST_F(PlanFile, GridLiesWhereItsYamlSays) {
  const std::string path =
      folder_.file("grid.yaml",
                   "rows: 12\ntrees: 40\nrow_spacing_m: 4.5\ntree_spacing_m: 3\n"
                   "corner_deg: [-27.6, 151.9]\nbearing_deg: 30\nrows_to: right\n"
                   "first_row: 7\n");
  const StoredPlan plan = read_plan(path, {});
  ASSERT_EQ(plan.plan.rows.size(), 12u);
  EXPECT_EQ(plan.plan.rows[0].name, "7");
  ASSERT_EQ(plan.plan.num_trees(), 480u);
  const auto place = [&](std::size_t r, std::size_t k) {
    return geometry::geodetic_of(*plan.georeference, plan.plan.rows[r].trees[k].p_plan);
  };
  // by the geodesic, which knows no map frame
  const auto& earth = GeographicLib::Geodesic::WGS84();
  double metres = 0.0, bearing = 0.0, back = 0.0;
  earth.Inverse(-27.6, 151.9, place(0, 39).latitude_deg, place(0, 39).longitude_deg, metres,
                bearing, back);
  EXPECT_NEAR(metres, 117.0, 0.005);
  EXPECT_NEAR(bearing, 30.0, 0.01);
  earth.Inverse(-27.6, 151.9, place(11, 0).latitude_deg, place(11, 0).longitude_deg, metres,
                bearing, back);
  EXPECT_NEAR(metres, 49.5, 0.005);
  EXPECT_NEAR(bearing, 120.0, 0.01);
}

TEST_F(PlanFile, GridOfTwoCornersIsThatOfItsBearing) {
  const std::string head = "rows: 3\ntrees: 40\nrow_spacing_m: 4.5\ncorner_deg: [-27.6, 151.9]\n";
  double latitude = 0.0, longitude = 0.0;
  GeographicLib::Geodesic::WGS84().Direct(-27.6, 151.9, 30.0, 117.0, latitude, longitude);
  const std::string end = fmt::format("row_end_deg: [{:.9f}, {:.9f}]\n", latitude, longitude);
  const StoredPlan by_end = read_plan(folder_.file("end.yaml", head + end), {});
  const StoredPlan by_bearing =
      read_plan(folder_.file("bearing.yaml", head + "tree_spacing_m: 3\nbearing_deg: 30\n"), {});
  ASSERT_EQ(by_end.plan.num_trees(), 120u);
  const mapping::OrchardPlan same = plan_in_map(by_end, *by_bearing.georeference);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t k = 0; k < 40; ++k) {
      EXPECT_LT((same.rows[r].trees[k].p_plan - by_bearing.plan.rows[r].trees[k].p_plan).norm(),
                0.02);
    }
  }
  const std::string near = "row_end_deg: [-27.6000001, 151.9]\n";
  EXPECT_NE(refusal(folder_.file("near.yaml", head + near)).find("0.00 m between trees"),
            std::string::npos);
  const std::string both = head + end + "bearing_deg: 30\n";
  EXPECT_NE(refusal(folder_.file("both.yaml", both)).find("leave bearing_deg"), std::string::npos);
}

TEST_F(PlanFile, RowsMayBeLines) {
  const std::string path =
      folder_.file("rows.geojson", R"({"type": "FeatureCollection", "features": [
    {"type": "Feature", "properties": {"name": "A"}, "geometry": {"type": "LineString",
     "coordinates": [[0.6, 41.6], [0.601, 41.6]]}},
    {"type": "Feature", "properties": {"name": "B"}, "geometry": {"type": "LineString",
     "coordinates": [[0.6, 41.60005], [0.601, 41.60005]]}}]})");
  EXPECT_NE(refusal(path).find("--spacing"), std::string::npos) << refusal(path);
  PlanFileOptions options;
  options.spacing_m = 4.0;
  const StoredPlan plan = read_plan(path, options);
  ASSERT_EQ(plan.plan.rows.size(), 2u);
  EXPECT_EQ(plan.plan.rows[1].name, "B");
  EXPECT_EQ(plan.plan.rows[0].trees.size(), 21u);  // a thousandth of a degree is 83.4 m there
  EXPECT_NEAR(mapping::typical_aisle_m(plan.plan), 5.55, 0.02);
}

TEST_F(PlanFile, ReadsItsOwnGeoJsonBack) {
  const std::string path = write_plan(small_plan(), in_spain(), kPlanKinds[0], folder_ / "plan");
  const StoredPlan plan = read_plan(path, {});
  const StoredPlan back = read_plan(folder_.file("back.geojson", plan_geojson(plan)), {});
  EXPECT_EQ(back.plan.num_trees(), 15u);
  EXPECT_EQ(plan_geojson(back), plan_geojson(plan));
}

TEST_F(PlanFile, SaysWhatIsWrong) {
  const auto says = [&](const std::string& path, const std::string& words,
                        const PlanFileOptions& options = {}) {
    const std::string text = refusal(path, options);
    EXPECT_NE(text.find(words), std::string::npos)
        << "\"" << text << "\" lacks \"" << words << "\"";
  };
  says(folder_ / "none.gpkg", "does not exist");
  says(folder_.path(), "is not a file");
  says(folder_.file("text.csv", "row,tree,x,y\n1,1,0,zero\n"),
       "feature 1: y = \"zero\" is not a number");
  says(folder_.file("nan.csv", "row,tree,x,y\n1,1,0,nan\n"), "is not on the earth");
  says(folder_.file("twice.csv", "row,tree,x,y\n1,1,0,0\n1,1,3,0\n"), "row 1 has two trees 1");
  says(folder_.file("zone.csv", "row,tree,x,y\n1,1,391444,6946623\n1,2,391447,6946623\n"), "--crs");
  says(folder_.file("far.csv", "row,tree,lat,lon\n1,1,41,0\n1,2,42,0\n"), "km from the middle");
  says(folder_.file("pole.csv", "row,tree,lat,lon\n1,1,141,0\n"), "is not on the earth");
  says(folder_.file("columns.csv", "row,tree,east_of_house\n1,1,4\n"), "no columns with positions");
  says(folder_.file("nothing.csv", ""), "nothing.csv");
  says(folder_.file("noise.gpkg", "no database at all"), "is not a GeoPackage");
  says(folder_.file("long.csv", "row,tree,x,y\n" + std::string(100, 'r') + ",1,0,0\n"),
       "the name must have at most 64 characters");
  PlanFileOptions options;
  options.row_field = "block";
  says(folder_.file("fields.csv", "row,tree,x,y\n1,1,0,0\n"),
       "no column block, only: row, tree, x, y", options);
  options = {};
  options.crs = "EPSG:nothing";
  says(folder_.file("crs.csv", "row,tree,x,y\n1,1,0,0\n"), "is not a coordinate system", options);
  says(folder_.file("typo.yaml", "rowz: 3\n"), "rows");
  says(folder_.file("less.yaml", "rows: 3\ntrees: 5\nrow_spacing_m: 4\n"), "tree_spacing_m");
}

TEST_F(PlanFile, NamesSurviveCsv) {
  const std::string path = folder_.file(
      "names.csv", "row,tree,x,y\n\"A, \"\"old\"\"\",1,0,0\n\"A, \"\"old\"\"\",2,3,0\n");
  const StoredPlan plan = read_plan(path, {});
  EXPECT_EQ(plan.plan.rows[0].name, "A, \"old\"");
  EXPECT_EQ(plan_names_csv({{17, {plan.plan.rows[0].name, "1"}}}),
            "id,row,tree\n17,\"A, \"\"old\"\"\",1\n");
  const std::string names = folder_.file(
      "back.csv", plan_names_csv({{17, {plan.plan.rows[0].name, "1"}}, {18, {"B", ""}}}));
  const auto back = read_plan_names(names);
  EXPECT_EQ(back.at(17).row, "A, \"old\"");
  EXPECT_EQ(back.at(18).tree, "");
  const auto says = [this](const char* line, const char* part) {
    const std::string bad = folder_.file("bad.csv", std::string("id,row,tree\n") + line);
    const std::string refusal = refusal_of([&] { read_plan_names(bad); });
    EXPECT_NE(refusal.find(part), std::string::npos) << line << refusal;
  };
  says("17,\"A,1\n", "bad.csv:2:4: a quote that is not closed");
  says("17,\"A\"B,1\n", "bad.csv:2:7: text after a closing quote");
  says("17,A\"B\",1\n", "bad.csv:2:5: a quote within a field");
  says("17,A,1\n17,A,2\n", "bad.csv:3:1: id: occurs twice");
  says("A,A,1\n", "bad.csv:2:1: id: must be a number");
  says("17,\"A,B\"\n", "bad.csv:2:1: 2 fields");
  says("", "names nothing");
  EXPECT_EQ(
      read_plan_names(folder_.file("ends.csv", "id,row,tree\r\n17,\"\",\"\"\"\"\r\n")).at(17).tree,
      "\"");
}

}  // namespace
}  // namespace orchard::io
