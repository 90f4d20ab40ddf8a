// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "vision/image.hpp"

namespace orchard::io {

/// A JPEG file as it is, with the size that its header states; utime and seq are left 0. Throws
/// FileError when it cannot be read, is over 16 MB or is no JPEG.
vision::Image read_jpeg_file(const std::string& path);

}  // namespace orchard::io
