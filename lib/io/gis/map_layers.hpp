// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/gis/geopackage.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// A map as GIS layers: `landmarks` (points with the columns of map.csv, the user's label, diameter
/// and cross-sectional area of a tree's trunk, latitude and longitude when georeferenced, a note),
/// `path` (a line per drive), `rows` (a line per row with its spacing), `gaps` (a point per empty
/// tree position), `aisles` and `headlands` (the paths between rows and around their ends) and
/// `nodes` (their intersections).
struct MapLayers {
  const std::vector<mapping::Landmark>* landmarks = nullptr;  ///< required
  std::vector<const std::vector<pose::PoseEstimate>*> trajectories;
  const std::vector<mapping::Row>* rows = nullptr;  ///< required
  const mapping::NavigationGraph* graph = nullptr;  ///< null: no aisles, headlands and nodes
  const std::optional<geometry::Georeference>* georeference = nullptr;  ///< required
  mapping::RowNames row_names{};
  std::map<std::int32_t, std::vector<std::string>> notes{};
  std::map<std::int32_t, std::string> photos{};  ///< paths in the map folder, by landmark id
  double keep_out_m = 0.0;  ///< margin of the layer keep-outs around landmarks; 0: no such layer
  int num_corrections = 0;  ///< corrections contained in the layers; stored in a GeoPackage
};

/// Name of that number in a GeoPackage's metadata.
inline constexpr char kCorrectionsMetadata[] = "ORCHARD_CORRECTIONS";

/// Writes all layers, each with its description and its QGIS style.
void write_map_layers(const MapLayers& layers, LayerFile& file);

/// Returns the map as a GeoPackage. Equal content gives equal bytes. Throws FileError when SQLite
/// fails.
std::string map_geopackage(const MapLayers& layers);

}  // namespace orchard::io
