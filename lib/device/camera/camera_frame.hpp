// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "vision/image.hpp"

namespace orchard::device {

/// Pixel formats of a camera.
enum class PixelFormat {
  kJpeg,  ///< a JPEG per picture (MJPEG)
  kYuyv,  ///< Y U Y V: two pixels in four bytes
  kGrey,  ///< one byte per pixel
  kBgr,   ///< three bytes per pixel
  kRgb,
};

/// One picture as delivered by a camera.
struct CameraFrame {
  std::int64_t utime = 0;  ///< mid-exposure, as accurate as the device tells [us]
  int width_px = 0;
  int height_px = 0;
  PixelFormat format = PixelFormat::kJpeg;
  int row_bytes = 0;  ///< of an uncompressed picture; may include padding
  std::vector<std::uint8_t> data;
};

/// Detects a camera that hangs: sensor noise makes any two real pictures differ, so identical bytes
/// mean a frozen stream.
class FrameWatch {
 public:
  void add(const std::vector<std::uint8_t>& data) {
    num_same_ = data == last_ ? num_same_ + 1 : 0;
    if (num_same_ == 0) last_ = data;
  }

  /// True after ten identical pictures in a row.
  bool is_frozen() const { return num_same_ >= kMaxSame; }

  void restart() { num_same_ = 0; }

 private:
  static constexpr int kMaxSame = 9;
  std::vector<std::uint8_t> last_;
  int num_same_ = 0;
};

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
