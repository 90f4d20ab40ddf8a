// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapping/album/photograph.hpp"

namespace orchard::io {

/// Where in a map folder the photograph of a landmark is.
std::string photo_path(std::int32_t landmark_id);

/// Writes album/ID.jpg and album/album.csv (`id,image_utime_us,x_px,y_px,width_px,height_px`: which
/// part of which IMAGE each is) into a map folder. Files that are there with the same bytes are
/// left alone, photographs of other landmarks removed; of no entries nothing stays. Each file is
/// replaced by renaming; throws FileError.
void write_album(const std::string& map_folder, const std::vector<mapping::AlbumEntry>& entries);

}  // namespace orchard::io
