// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/corrections/edited_map.hpp"

namespace orchard::io {

/// A map's GeoPackage after somebody edited it.
struct EditedMapFile {
  mapping::EditedMap map;
  int num_corrections = 0;            ///< that it held when it was written; 0 for the map of a run
  std::vector<std::string> left_out;  ///< what no correction can say, a sentence each
};

/// Reads the layers `landmarks` and `rows` of a GeoPackage that map_geopackage() or `orchard
/// export` wrote, in the map's frame. Throws FileError naming file, feature and what to do.
EditedMapFile read_edited_map(const std::string& path,
                              const std::optional<geometry::Georeference>& georeference);

}  // namespace orchard::io
