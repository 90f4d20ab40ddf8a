// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "vision/image.hpp"

namespace orchard::io {

/// Reads all of a picture's file. Throws FileError when it cannot be read, is empty or over 16 MB.
std::vector<std::uint8_t> read_picture_bytes(const std::string& path);

/// Reads a JPEG file without decoding it, with the size from its header; utime and seq are left 0.
/// Throws FileError when it cannot be read, is over 16 MB or is not a JPEG.
vision::Image read_jpeg_file(const std::string& path);

/// Wraps JPEG bytes in an image, with the size from its header; utime and seq are left 0. None when
/// the bytes are not a JPEG.
std::optional<vision::Image> jpeg_image(const std::uint8_t* data, std::size_t size);

}  // namespace orchard::io
