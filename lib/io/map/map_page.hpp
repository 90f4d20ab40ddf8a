// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "io/map/map_folder.hpp"
#include "view/map_data.hpp"
#include "view/map_tiles.hpp"

namespace orchard::io {

/// What map.html shows of a map; `content` must exist as long as it.
view::MapData page_data(const MapFolderContent& content,
                        const std::vector<mapping::AlbumEntry>& album);

/// map.html as text: the map as one page, with the album's photographs embedded, that a browser
/// opens from a disk without a network. Equal content gives equal bytes.
std::string map_page(const view::MapData& data);

/// The same of a large map: its tiles and the album's photographs are files beside the page.
std::string map_page(const view::MapData& data, const view::MapTiles& tiles);

}  // namespace orchard::io
