// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "device/camera/camera_frame.hpp"
#include "vision/image.hpp"

namespace orchard::device {

/// Why a frame became no picture, in words for a person.
struct NoPicture {
  std::string why;
};

/// Turns frames into JPEG pictures of at most so many bytes. A camera's own JPEG that is small
/// enough passes unchanged; a larger one and uncompressed pixels are compressed with the best
/// quality, at most 90, that keeps the limit.
class PictureLimit {
 public:
  explicit PictureLimit(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// seq is left 0. NoPicture: no whole JPEG, sizes that contradict each other, or beyond the limit
  /// even with quality 25.
  std::variant<vision::Image, NoPicture> fit(CameraFrame frame);

  /// Of the last picture that was compressed here; 0: none was.
  int quality() const { return quality_; }

 private:
  std::size_t max_bytes_;
  int quality_ = 0;
};

}  // namespace orchard::device
