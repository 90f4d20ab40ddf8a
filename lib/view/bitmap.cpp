// SPDX-License-Identifier: BSD-3-Clause
#include "view/bitmap.hpp"

#include <cstddef>
#include <cstdint>

namespace orchard::view {
namespace {

/// Little-endian, as required by the format.
void add_number(std::string& bytes, std::uint32_t value, int num_bytes) {
  for (int k = 0; k < num_bytes; ++k) bytes += static_cast<char>(value >> (8 * k));
}

}  // namespace

std::string bitmap(const vision::Image& image) {
  const bool is_gray = image.encoding == vision::Encoding::kGray8;
  if (image.encoding == vision::Encoding::kJpeg || image.width_px <= 0 || image.height_px <= 0) {
    return {};
  }
  const auto wide = static_cast<std::size_t>(image.width_px);
  const auto high = static_cast<std::size_t>(image.height_px);
  if (image.data.size() != wide * high * (is_gray ? 1 : 3)) return {};
  const std::size_t padding = (4 - 3 * wide % 4) % 4;
  constexpr std::size_t kHeader = 54;
  const std::size_t size = kHeader + high * (3 * wide + padding);
  std::string bytes = "BM";
  bytes.reserve(size);
  add_number(bytes, static_cast<std::uint32_t>(size), 4);
  add_number(bytes, 0, 4);
  add_number(bytes, kHeader, 4);
  add_number(bytes, 40, 4);  // size of the following header
  add_number(bytes, static_cast<std::uint32_t>(wide), 4);
  add_number(bytes, static_cast<std::uint32_t>(high), 4);
  add_number(bytes, 1, 2);   // planes
  add_number(bytes, 24, 2);  // bits per pixel
  for (int k = 0; k < 6; ++k) add_number(bytes, 0, 4);
  for (std::size_t row = high; row-- > 0;) {  // bottom row first
    for (std::size_t k = row * wide; k < (row + 1) * wide; ++k) {
      for (std::size_t c = 0; c < 3; ++c) {
        bytes += static_cast<char>(image.data[is_gray ? k : 3 * k + c]);
      }
    }
    bytes.append(padding, '\0');
  }
  return bytes;
}

}  // namespace orchard::view
