// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/image.hpp"
#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Reads parts of one picture for several who look at it, and decodes it once for all of them: the
/// entropy decoding of a JPEG costs the same however little of it is wanted.
class PictureReader {
 public:
  /// `image` must outlive the reader.
  explicit PictureReader(const Image& image) : image_(image) {}

  const Image& image() const { return image_; }

  /// Says that this part will be read later, so that the next read() decodes it along.
  void expect(const PixelRect& region) { expected_ = bounding(expected_, region); }

  /// As decode() of the image: the same pixels, or none, whatever else was read or expected.
  std::optional<PixelBlock> read(const PixelRect& region);

 private:
  const Image& image_;
  PixelRect expected_;
  std::optional<PixelBlock> decoded_;
};

}  // namespace orchard::vision
