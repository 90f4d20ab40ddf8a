// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

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

}  // namespace orchard::device
