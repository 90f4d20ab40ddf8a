// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/georeference.hpp"
#include "mapping/corrections/edited_map.hpp"

namespace orchard::io {

/// A map's GeoPackage after manual editing.
struct EditedMapFile {
  mapping::EditedMap map;
  int num_corrections = 0;            ///< contained in it when it was written
  std::vector<std::string> left_out;  ///< edits that no correction can express, one sentence each
};

/// Reads the layers `landmarks` and `rows` of a GeoPackage that map_geopackage() or `orchard
/// export` wrote, in the map's frame. Throws FileError naming the file, the feature and the remedy.
EditedMapFile read_edited_map(const std::string& path,
                              const std::optional<geometry::Georeference>& georeference);

}  // namespace orchard::io
