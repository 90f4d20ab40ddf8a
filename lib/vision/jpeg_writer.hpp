// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// The pixels as a JPEG of that quality (1 to 100), chroma halved both ways. Equal pixels give
/// equal bytes on one machine. Empty when the block is.
std::vector<std::uint8_t> write_jpeg(const PixelBlock& block, int quality);

/// The block with each side divided by `divisor`, every pixel the mean of those it stands for; what
/// is left over at the right and below is cut off. `area` stays that in the picture.
PixelBlock shrunk(const PixelBlock& block, int divisor);

}  // namespace orchard::vision
