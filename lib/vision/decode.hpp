// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Decodes a region of an image of any encoding.
///
/// None if the bytes are no image of the stated size, if `region` is empty or not inside the image,
/// and for GRAY8, because the detector needs colour.
std::optional<PixelBlock> decode(const Image& image, const PixelRect& region);

}  // namespace orchard::vision
