// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Decodes a region of a JPEG image. Of the rest of the image only the entropy coding is decoded.
///
/// The pixels equal those of cv::imdecode of the whole image (without rotation by EXIF). None if
/// the bytes are no JPEG of width_px x height_px with one or three components, if the codec reports
/// an error or a warning up to the last row of `region`, if the JPEG has too many scans, or if
/// `region` is empty or not inside the image. Invalid bytes never cause an exception.
std::optional<PixelBlock> decode_jpeg_region(const std::uint8_t* data, std::size_t size,
                                             int width_px, int height_px, const PixelRect& region);

}  // namespace orchard::vision
