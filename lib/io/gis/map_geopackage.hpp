// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/navigation_graph.hpp"
#include "mapping/rows/rows.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::io {

/// The map as a GeoPackage: layers `landmarks` (points with the columns of map.csv, and latitude
/// and longitude when georeferenced), `path` (one line), `rows` (a line per row with its
/// spacing), `gaps` (a point per place without a tree), `alleys` and `headlands` (the ways between
/// rows and round their ends) and `nodes` (where ways meet). In the UTM zone of the georeference,
/// without one in a local metric system. `photos`: paths of photographs by id, beside the file.
/// Equal content gives equal bytes. Throws FileError when GDAL fails.
std::string map_geopackage(const std::vector<mapping::Landmark>& landmarks,
                           const std::vector<pose::PoseEstimate>& trajectory,
                           const std::vector<mapping::Row>& rows,
                           const mapping::NavigationGraph& graph,
                           const std::optional<geometry::Georeference>& georeference,
                           const std::map<std::int32_t, std::string>& photos = {});

}  // namespace orchard::io
