// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "vision/image.hpp"

namespace orchard::io {

/// Reads a JPEG file without decoding it, or a PNG file decoded to GRAY8; utime and seq are left 0.
/// Throws FileError when it cannot be read, is over 16 MB, is of another format, or is larger than
/// 8192 pixels per side.
vision::Image read_picture_file(const std::string& path);

/// Whether the extension is one that read_picture_file() supports.
bool has_picture_name(const std::string& path);

}  // namespace orchard::io
