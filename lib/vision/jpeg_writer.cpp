// SPDX-License-Identifier: BSD-3-Clause
#include "vision/jpeg_writer.hpp"

#include <turbojpeg.h>

#include <memory>

namespace orchard::vision {

std::vector<std::uint8_t> write_jpeg(const PixelBlock& block, int quality,
                                     JpegTransform transform) {
  if (block.area.empty()) return {};
  const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), tjDestroy);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const int result =
      encoder ? tjCompress2(encoder.get(), block.bgr.data(), block.area.width_px, 0,
                            block.area.height_px, TJPF_BGR, &buffer, &size, TJSAMP_420, quality,
                            transform == JpegTransform::kExact ? TJFLAG_ACCURATEDCT : 0)
              : -1;
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(buffer, tjFree);
  if (result != 0) return {};
  return std::vector<std::uint8_t>(buffer, buffer + size);
}

PixelBlock shrunk(const PixelBlock& block, int divisor) {
  if (divisor <= 1) return block;
  PixelBlock small;
  small.area = block.area;
  small.area.width_px /= divisor;
  small.area.height_px /= divisor;
  const auto columns = static_cast<std::size_t>(block.area.width_px);
  const auto step = static_cast<std::size_t>(divisor);
  const auto num = static_cast<unsigned>(step * step);
  const auto width = static_cast<std::size_t>(small.area.width_px);
  const auto height = static_cast<std::size_t>(small.area.height_px);
  small.bgr.reserve(3 * width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        unsigned sum = num / 2;
        for (std::size_t dy = 0; dy < step; ++dy) {
          for (std::size_t dx = 0; dx < step; ++dx) {
            sum += block.bgr[3 * ((y * step + dy) * columns + x * step + dx) + c];
          }
        }
        small.bgr.push_back(static_cast<std::uint8_t>(sum / num));
      }
    }
  }
  return small;
}

}  // namespace orchard::vision
