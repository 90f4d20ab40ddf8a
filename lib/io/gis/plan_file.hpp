// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/plan/orchard_plan.hpp"

namespace orchard::io {

struct PlanFileOptions {
  std::string layer;       ///< layer to read; empty: the only one
  std::string row_field;   ///< empty: row, row_name ... (kRowFields)
  std::string tree_field;  ///< empty: tree, position ... (kTreeFields)
  std::string crs;         ///< such as EPSG:25830, if the file does not give one; empty: none
  double spacing_m = 0.0;  ///< between trees, if the file has rows as lines; 0: unknown
};

/// A plan read from a file.
struct StoredPlan {
  std::string name;    ///< file name, for messages
  std::string format;  ///< GeoPackage, CSV ...
  std::string crs;     ///< name by its authority; "local" for none
  mapping::OrchardPlan plan;
  /// Pose of the plan's frame: x axis to the east, origin amid the trees. None: the file's own flat
  /// frame in metres, not tied to the earth.
  std::optional<geometry::Georeference> georeference;
  std::vector<std::string> notes;  ///< decisions made while reading, one sentence each
};

/// Reads a grower's plan: trees as points or rows as lines from a GeoPackage, Shapefile, GeoJSON,
/// KML, DXF or CSV through GDAL, in any coordinate system; or a regular grid from YAML (its keys:
/// README.md). Throws FileError naming the file, the feature and the remedy.
StoredPlan read_plan(const std::string& path, const PlanFileOptions& options);

/// Transforms the plan into the map frame by the two georeferences; exact apart from heights. A
/// plan without georeference is returned unchanged.
mapping::OrchardPlan plan_in_map(const StoredPlan& plan, const geometry::Georeference& of_map);

}  // namespace orchard::io
