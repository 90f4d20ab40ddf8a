// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/image.hpp"

namespace orchard::io {

/// Which pixels a PNG is decoded to; as they are, one of more than 8 bits is refused.
enum class PngColours { kGrey, kAsTheyAre };

/// Decodes a PNG of at most 8192 pixels per side, which its header tells before anything is
/// decoded, to GRAY8 or BGR8; utime and seq are left 0. None for anything else, or when it is
/// damaged.
std::optional<vision::Image> png_image(const std::uint8_t* data, std::size_t size,
                                       PngColours colours);

/// Reads a JPEG file without decoding it, or a PNG file decoded to GRAY8; utime and seq are left 0.
/// Throws FileError when it cannot be read, is over 16 MB, is of another format, or is larger than
/// 8192 pixels per side.
vision::Image read_picture_file(const std::string& path);

/// Whether the extension is one that read_picture_file() supports.
bool has_picture_name(const std::string& path);

}  // namespace orchard::io
