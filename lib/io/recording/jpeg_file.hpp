// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "vision/image.hpp"

namespace orchard::io {

/// A JPEG file as it is, with the size that its header states; utime and seq are left 0. Throws
/// FileError when it cannot be read, is over 16 MB or is no JPEG.
vision::Image read_jpeg_file(const std::string& path);

/// A JPEG as it lies in memory, with the size that its header states; utime and seq are left 0.
/// None when the bytes are no JPEG.
std::optional<vision::Image> jpeg_image(const std::uint8_t* data, std::size_t size);

}  // namespace orchard::io
