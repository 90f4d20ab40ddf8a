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

/// The size a JPEG's frame header states, or none when the bytes are no JPEG or end before it.
std::optional<JpegSize> find_jpeg_size(const std::vector<std::uint8_t>& data);

}  // namespace orchard::bus
