// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/jpeg_header.hpp"

#include <cstddef>

namespace orchard::bus {

std::optional<JpegSize> find_jpeg_size(const std::vector<std::uint8_t>& data) {
  const std::size_t size = data.size();
  if (size < 4 || data[0] != 0xFF || data[1] != 0xD8) return std::nullopt;
  std::size_t i = 2;
  while (i + 4 <= size) {
    if (data[i] != 0xFF) return std::nullopt;
    const std::uint8_t marker = data[i + 1];
    if (marker == 0xFF) {  // fill byte
      ++i;
      continue;
    }
    const std::size_t length = std::size_t{data[i + 2]} << 8 | data[i + 3];
    // Frame headers are C0..CF apart from DHT (C4), JPG (C8) and DAC (CC).
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      if (length < 8 || i + 9 > size) return std::nullopt;
      JpegSize found;
      found.height_px = data[i + 5] << 8 | data[i + 6];
      found.width_px = data[i + 7] << 8 | data[i + 8];
      return found;
    }
    if (marker == 0xDA || marker == 0xD9 || length < 2) return std::nullopt;
    i += 2 + length;
  }
  return std::nullopt;
}

}  // namespace orchard::bus
