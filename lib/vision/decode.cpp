// SPDX-License-Identifier: BSD-3-Clause
#include "vision/decode.hpp"

#include <cstddef>
#include <cstring>

#include "vision/jpeg_region.hpp"

namespace orchard::vision {
namespace {

std::optional<PixelBlock> cut_bgr(const Image& image, const PixelRect& region) {
  const PixelRect picture{0, 0, image.width_px, image.height_px};
  const std::size_t stride = 3u * static_cast<std::size_t>(image.width_px);
  if (region.empty() || !picture.contains(region)) return std::nullopt;
  if (image.data.size() != stride * static_cast<std::size_t>(image.height_px)) return std::nullopt;
  PixelBlock block;
  block.area = region;
  const std::size_t row_bytes = 3u * static_cast<std::size_t>(region.width_px);
  block.bgr.resize(row_bytes * static_cast<std::size_t>(region.height_px));
  for (int y = 0; y < region.height_px; ++y) {
    std::memcpy(block.bgr.data() + row_bytes * static_cast<std::size_t>(y),
                image.data.data() + stride * static_cast<std::size_t>(region.y_px + y) +
                    3u * static_cast<std::size_t>(region.x_px),
                row_bytes);
  }
  return block;
}

}  // namespace

std::optional<PixelBlock> decode(const Image& image, const PixelRect& region) {
  if (image.width_px <= 0 || image.height_px <= 0) return std::nullopt;
  switch (image.encoding) {
    case Encoding::kJpeg:
      return decode_jpeg_region(image.data.data(), image.data.size(), image.width_px,
                                image.height_px, region);
    case Encoding::kBgr8:
      return cut_bgr(image, region);
    case Encoding::kGray8:
      break;
  }
  return std::nullopt;
}

}  // namespace orchard::vision
