// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/gis/geo_file.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// A map as layers: `landmarks` (points with the columns of map.csv, the label that people know,
/// diameter and cross-sectional area of a tree's trunk, latitude and longitude when georeferenced,
/// a note), `path` (a line per drive), `rows` (a line per row with its spacing), `gaps` (a point
/// per place without a tree), `alleys` and `headlands` (the ways between rows and round their ends)
/// and `nodes` (where ways meet).
struct MapLayers {
  const std::vector<mapping::Landmark>* landmarks = nullptr;  ///< never null when written
  std::vector<const std::vector<pose::PoseEstimate>*> trajectories;
  const std::vector<mapping::Row>* rows = nullptr;  ///< never null when written
  const mapping::NavigationGraph* graph = nullptr;  ///< null: no ways are written
  const std::optional<geometry::Georeference>* georeference = nullptr;  ///< never null
  std::map<std::int32_t, std::string> row_names{};  ///< of rows that people call otherwise
  std::map<std::int32_t, std::vector<std::string>> notes{};
  std::map<std::int32_t, std::string> photos{};  ///< paths in the map folder, by id
  int num_corrections = 0;  ///< that the layers hold; a GeoPackage says so to who reads it again
};

/// The name of that number among a GeoPackage's metadata.
inline constexpr char kCorrectionsMetadata[] = "ORCHARD_CORRECTIONS";

/// Writes all layers, each with its description and the style in which QGIS opens it.
void write_map_layers(const MapLayers& layers, GeoFile& file);

/// The map as a GeoPackage. Equal content gives equal bytes. Throws FileError when GDAL fails.
std::string map_geopackage(const MapLayers& layers);

}  // namespace orchard::io
