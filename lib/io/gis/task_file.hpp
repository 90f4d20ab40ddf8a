// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "io/gis/geopackage.hpp"
#include "mapping/inventory/tasks.hpp"

namespace orchard::io {

/// Writes tasks as a layer `tasks` of points, with the columns `task,state,what,row,tree,why,since,
/// seen,note,label`; state is `open` or `done`.
void write_tasks(const std::vector<mapping::Task>& tasks, LayerFile& file);

/// Reads such a layer from a GeoJSON or GeoPackage, as ticked, in the frame of the map: a state, a
/// note or a point may have been changed, points may have been added or deleted. Throws FileError
/// naming the file, the feature and the remedy.
std::vector<mapping::Task> read_tasks(const std::string& path,
                                      const std::optional<geometry::Georeference>& georeference);

}  // namespace orchard::io
