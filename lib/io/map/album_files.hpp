// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mapping/album/album.hpp"

namespace orchard::io {

/// Path of a landmark's photograph in a map folder.
std::string photo_path(std::int32_t landmark_id);

/// Writes album/ID.jpg and album/album.csv (`id,image_utime_us,x_px,y_px,width_px,height_px`: the
/// source image and the crop) into a map folder. Existing files with equal bytes are kept,
/// photographs of other landmarks are removed; without entries the album is removed. Each file is
/// replaced by renaming. Throws FileError.
void write_album(const std::string& map_folder, const std::vector<mapping::AlbumEntry>& entries);

}  // namespace orchard::io
