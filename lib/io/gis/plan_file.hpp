// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/plan/orchard_plan.hpp"

namespace orchard::io {

struct PlanFileOptions {
  std::string layer;       ///< of a file with several; empty: the only one
  std::string row_field;   ///< empty: row, row_name ... (kRowFields)
  std::string tree_field;  ///< empty: tree, position ... (kTreeFields)
  std::string crs;         ///< such as EPSG:25830, where the file does not say; empty: none
  double spacing_m = 0.0;  ///< between trees, where the file has rows as lines; 0: not known
};

/// A plan as it was read from its file.
struct StoredPlan {
  std::string name;    ///< of the file, for messages
  std::string format;  ///< GeoPackage, CSV ...
  std::string crs;     ///< as its authority names it; "local" for none
  mapping::OrchardPlan plan;
  /// Where the plan's frame lies: its x axis to the east, its origin amid the trees. None: the
  /// file's own flat frame in metres, not tied to the earth.
  std::optional<geometry::Georeference> georeference;
  std::vector<std::string> notes;  ///< what was decided on the way, a sentence each
};

/// Reads a grower's plan: trees as points or rows as lines from a GeoPackage, Shapefile, GeoJSON,
/// KML, DXF or CSV through GDAL, in any coordinate system; or a regular grid from YAML (its keys:
/// README.md). Throws FileError naming file, feature and what to do.
StoredPlan read_plan(const std::string& path, const PlanFileOptions& options);

/// The plan in map, by the two georeferences; heights apart exact.
mapping::OrchardPlan plan_in_map(const StoredPlan& plan, const geometry::Georeference& of_map);

}  // namespace orchard::io
