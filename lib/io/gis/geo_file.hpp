// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/gis/geopackage.hpp"

namespace orchard::io {

/// File formats for a map's layers.
enum class GeoFormat {
  kGeoPackage,
  kGeoJson,
  kKml,
  kShapefile,       ///< all layers in one archive
  kShapefileParts,  ///< one layer, as a file with others beside it
  kDxf,
  kCsv,
  kFlatGeobuf,
  kGpx,
  kRouteGraph,  ///< this and the following: robot_files.hpp
  kTopologicalMap,
  kOccupancyGrid,
  kKitti
};

/// Name and properties of a format.
struct GeoFormatInfo {
  GeoFormat format;
  const char* word;       ///< "geojson"
  const char* extension;  ///< ".geojson"
  const char* driver;     ///< in GDAL; empty: robot_files.hpp
  bool has_one_layer;
  bool is_on_earth;  ///< stores latitude and longitude only: needs a georeference
  const char* lost;  ///< what it cannot store, as a sentence; "": nothing
};

/// Lists all formats, GeoPackage first; a word may stand for several, by the file's extension.
const std::vector<GeoFormatInfo>& geo_formats();

/// Name of the coordinate system in which a format stores a map.
std::string geo_system_text(const std::optional<geometry::Georeference>& georeference,
                            const GeoFormatInfo& format);

/// A file of that format. With a georeference, points are written in the UTM zone of its datum (WGS
/// 84), or as latitude and longitude if the format supports nothing else; without one in a local
/// metric system that is not tied to the earth. A GeoPackage is written by GeoPackage, every other
/// format by GDAL. Throws FileError when GDAL fails.
std::unique_ptr<LayerFile> geo_file(const std::optional<geometry::Georeference>& georeference,
                                    GeoFormat format);

}  // namespace orchard::io
