// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::calibration {

/// A grey image: rows top-down, no padding.
struct GreyPicture {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> grey;  ///< width_px x height_px
};

/// Converts decoded pixels to grey (Rec. 601, as OpenCV).
GreyPicture grey_of(const vision::PixelBlock& pixels);

/// Decodes an image of any encoding to grey. None when the bytes are no image of the stated size.
std::optional<GreyPicture> grey_of(const vision::Image& image);

}  // namespace orchard::calibration
