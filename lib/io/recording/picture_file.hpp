// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "vision/image.hpp"

namespace orchard::io {

/// A JPEG file as it is, or a PNG file decoded to GRAY8; utime and seq are left 0. Throws FileError
/// when it cannot be read, is over 16 MB, is neither, or is larger than 8192 pixels a side.
vision::Image read_picture_file(const std::string& path);

/// Whether a file's name ends as that of a picture which read_picture_file() may read.
bool has_picture_name(const std::string& path);

}  // namespace orchard::io
