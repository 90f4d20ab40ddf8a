// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Decodes a part of a JPEG picture, sparing the rest all but the entropy decoding.
///
/// The pixels equal cv::imdecode's of the whole picture (without its rotation by EXIF). Gives none
/// for bytes that are no JPEG of width_px x height_px with one or three components, that the codec
/// has any complaint about up to the last row of `region`, or whose number of scans is absurd.
/// `region` must lie inside the picture. Throws nothing on account of the bytes.
std::optional<PixelBlock> decode_jpeg_region(const std::uint8_t* data, std::size_t size,
                                             int width_px, int height_px, const PixelRect& region);

}  // namespace orchard::vision
