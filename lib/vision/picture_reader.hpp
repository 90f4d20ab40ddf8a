// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

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
