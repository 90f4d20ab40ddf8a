// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map/map_folder.hpp"
#include "mapping/rows/navigation_graph.hpp"

namespace orchard::io {

/// map.html as text: the map as one page, with the album's photographs embedded, that a browser
/// opens from a disk without a network. Equal content gives equal bytes.
std::string map_page(const MapFolderContent& content, const mapping::NavigationGraph& graph,
                     const std::vector<mapping::AlbumEntry>& album);

}  // namespace orchard::io
