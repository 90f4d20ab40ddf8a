// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace orchard::bus {

struct JpegSize {
  int width_px = 0;
  int height_px = 0;
};

/// Reads the image size from a JPEG's frame header. None when the bytes are not a JPEG or end
/// before that header.
std::optional<JpegSize> find_jpeg_size(const std::vector<std::uint8_t>& data);

}  // namespace orchard::bus
