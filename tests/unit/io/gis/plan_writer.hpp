// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>

#include "geometry/georeference.hpp"
#include "mapping/plan/orchard_plan.hpp"

namespace orchard::io {

/// A kind of file that a grower may have, with its extension.
struct PlanKind {
  const char* driver;
  const char* extension;
  const char* crs;  ///< empty: latitude and longitude
  bool needs_crs;   ///< the file cannot say which it has
};
inline constexpr PlanKind kPlanKinds[] = {
    {"GPKG", "gpkg", "EPSG:3857", false},  {"ESRI Shapefile", "shp", "EPSG:32630", false},
    {"GeoJSON", "geojson", "", false},     {"LIBKML", "kml", "", false},
    {"DXF", "dxf", "EPSG:25830", true},    {"CSV", "csv", "", false},
    {"CSV", "csv", "EPSG:25830", true},    {"FlatGeobuf", "fgb", "EPSG:2154", false},
    {"GPKG", "gpkg", "EPSG:27700", false},
};

inline void require(bool holds) {
  if (!holds) throw std::runtime_error("a plan for the test could not be written");
}

/// Writes a plan whose frame lies on the earth as `georeference` says, by GDAL's own writers and
/// transformations. A DXF gets a layer for each row and no tree names.
inline std::string write_plan(const mapping::OrchardPlan& plan,
                              const geometry::Georeference& georeference, const PlanKind& kind,
                              const std::string& stem) {
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

}  // namespace orchard::io
