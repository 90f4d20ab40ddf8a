// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace orchard::device {

/// How a camera gives its pixels.
enum class PixelFormat {
  kJpeg,  ///< a JPEG per picture (MJPEG)
  kYuyv,  ///< Y U Y V: two pixels in four bytes
  kGrey,  ///< one byte a pixel
  kBgr,   ///< three bytes a pixel
  kRgb,
};

/// One picture as a camera gave it.
struct CameraFrame {
  std::int64_t utime = 0;  ///< mid-exposure, as well as the device says [us]
  int width_px = 0;
  int height_px = 0;
  PixelFormat format = PixelFormat::kJpeg;
  int row_bytes = 0;  ///< of an uncompressed picture, at least its pixels
  std::vector<std::uint8_t> data;
};

}  // namespace orchard::device
