// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

enum class JpegTransform {
  kFast,
  kExact,  ///< as most encoders do by default; a third slower
};

/// Encodes a block as JPEG with the given quality (1 to 100) and 4:2:0 chroma subsampling. Equal
/// pixels give equal bytes on the same machine. Empty if the block is empty.
std::vector<std::uint8_t> write_jpeg(const PixelBlock& block, int quality,
                                     JpegTransform transform = JpegTransform::kFast);

/// Reduces a block by `divisor` in both directions; each pixel is the mean of the pixels that it
/// replaces. Remaining columns at the right and rows at the bottom are dropped. `area` keeps the
/// coordinates of the original image.
PixelBlock shrunk(const PixelBlock& block, int divisor);

}  // namespace orchard::vision
