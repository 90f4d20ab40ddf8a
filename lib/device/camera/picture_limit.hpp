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

/// The reason why a frame gave no picture, as text for the user.
struct NoPicture {
  std::string why;
};

/// Converts frames to JPEG pictures of limited size in bytes. A camera's own JPEG within the limit
/// passes unchanged; a larger one and uncompressed pixels are compressed with the best quality, at
/// most 90, that keeps the limit.
class PictureLimit {
 public:
  explicit PictureLimit(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Converts one frame; seq is left 0. NoPicture: an incomplete JPEG, inconsistent sizes, or a
  /// picture above the limit even with quality 25.
  std::variant<vision::Image, NoPicture> fit(CameraFrame frame);

  /// JPEG quality of the last picture compressed here; 0: none yet.
  int quality() const { return quality_; }

 private:
  std::size_t max_bytes_;
  int quality_ = 0;
};

}  // namespace orchard::device
