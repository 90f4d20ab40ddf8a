// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// The pixels of a part of a picture, whatever its encoding.
///
/// Gives none when the bytes do not make a picture of the stated size, when `region` is empty or
/// not inside it, and for GRAY8, which has no colour to judge a trunk by.
std::optional<PixelBlock> decode(const Image& image, const PixelRect& region);

}  // namespace orchard::vision
