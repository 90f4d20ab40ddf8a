// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::calibration {

/// A whole picture without colour: rows top-down, no padding.
struct GreyPicture {
  int width_px = 0;
  int height_px = 0;
  std::vector<std::uint8_t> grey;  ///< width_px x height_px
};

/// The brightness of decoded pixels (Rec. 601, as OpenCV computes it).
GreyPicture grey_of(const vision::PixelBlock& pixels);

/// A picture of any encoding without its colour. Gives none when the bytes do not make a picture
/// of the stated size.
std::optional<GreyPicture> grey_of(const vision::Image& image);

}  // namespace orchard::calibration
