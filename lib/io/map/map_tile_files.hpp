// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "view/map_tiles.hpp"

namespace orchard::io {

/// Writes `map_tiles/` of a map folder: the parts of a large map that map.html loads when they are
/// in view, and which part has which landmark (index.js). As a page on a disk may load scripts but
/// no data, each is a script. Null: removes those of an earlier map. Throws FileError.
void write_map_tiles(const std::string& map_folder, const view::MapTiles* tiles);

}  // namespace orchard::io
