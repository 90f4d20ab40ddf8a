// SPDX-License-Identifier: BSD-3-Clause
#include "vision/picture_reader.hpp"

#include <cstddef>

#include "vision/decode.hpp"

namespace orchard::vision {
namespace {

PixelBlock part_of(const PixelBlock& block, const PixelRect& region) {
  PixelBlock part;
  part.area = region;
  const std::size_t stride = 3u * static_cast<std::size_t>(block.area.width_px);
  const std::size_t row_bytes = 3u * static_cast<std::size_t>(region.width_px);
  part.bgr.reserve(row_bytes * static_cast<std::size_t>(region.height_px));
  const std::uint8_t* row = block.bgr.data() +
                            stride * static_cast<std::size_t>(region.y_px - block.area.y_px) +
                            3u * static_cast<std::size_t>(region.x_px - block.area.x_px);
  for (int y = 0; y < region.height_px; ++y, row += stride) {
    part.bgr.insert(part.bgr.end(), row, row + row_bytes);
  }
  return part;
}

}  // namespace

std::optional<PixelBlock> PictureReader::read(const PixelRect& region) {
  if (region.empty()) return std::nullopt;
  if (expected_.empty()) return decode(image_, region);
  if (!decoded_ || !decoded_->area.contains(region)) {
    decoded_ = decode(image_, bounding(region, expected_));
  }
  // If the larger area is damaged, this region may still decode on its own.
  return decoded_ ? part_of(*decoded_, region) : decode(image_, region);
}

}  // namespace orchard::vision
