// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "vision/image.hpp"
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

/// Decodes a region of an image of any encoding.
///
/// None if the bytes are no image of the stated size, if `region` is empty or not inside the image,
/// and for GRAY8, because the detector needs colour.
std::optional<PixelBlock> decode(const Image& image, const PixelRect& region);

/// Reads regions of one image for several consumers and decodes the image once for all of them,
/// because the entropy decoding of a JPEG costs the same for any region.
class PictureReader {
 public:
  /// `image` must outlive the reader.
  explicit PictureReader(const Image& image) : image_(image) {}

  const Image& image() const { return image_; }

  /// Announces a region that will be read later; the next read() that decodes includes it.
  void expect(const PixelRect& region) { expected_ = bounding(expected_, region); }

  /// Returns the same as decode() of this region, independent of other reads and announcements.
  std::optional<PixelBlock> read(const PixelRect& region);

 private:
  const Image& image_;
  PixelRect expected_;
  std::optional<PixelBlock> decoded_;
};

}  // namespace orchard::vision
