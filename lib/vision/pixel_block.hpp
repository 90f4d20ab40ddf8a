// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace orchard::vision {

/// A rectangle of whole pixels in image coordinates; empty when a side is 0.
struct PixelRect {
  int x_px = 0;  ///< left column
  int y_px = 0;  ///< top row
  int width_px = 0;
  int height_px = 0;

  bool empty() const { return width_px <= 0 || height_px <= 0; }
  bool contains(const PixelRect& other) const {
    return other.x_px >= x_px && other.y_px >= y_px &&
           other.x_px + other.width_px <= x_px + width_px &&
           other.y_px + other.height_px <= y_px + height_px;
  }
};

/// The intersection of two rectangles; empty when they are disjoint.
inline PixelRect intersection(const PixelRect& a, const PixelRect& b) {
  const int x0 = std::max(a.x_px, b.x_px), y0 = std::max(a.y_px, b.y_px);
  const int x1 = std::min(a.x_px + a.width_px, b.x_px + b.width_px);
  const int y1 = std::min(a.y_px + a.height_px, b.y_px + b.height_px);
  if (x1 <= x0 || y1 <= y0) return {};
  return {x0, y0, x1 - x0, y1 - y0};
}

/// The smallest rectangle that contains both; empty rectangles are ignored.
inline PixelRect bounding(const PixelRect& a, const PixelRect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  const int x0 = std::min(a.x_px, b.x_px), y0 = std::min(a.y_px, b.y_px);
  const int x1 = std::max(a.x_px + a.width_px, b.x_px + b.width_px);
  const int y1 = std::max(a.y_px + a.height_px, b.y_px + b.height_px);
  return {x0, y0, x1 - x0, y1 - y0};
}

/// Decoded pixels of a region of an image: rows top-down, blue green red, no padding.
struct PixelBlock {
  PixelRect area;                 ///< the region in the image
  std::vector<std::uint8_t> bgr;  ///< 3 x area.width_px x area.height_px
};

/// Computes the window of a given size in metres around a projected point, clipped to the image.
/// Pixels = focal length x metres / depth, so its size is inversely proportional to range.
///
/// None if the clipped window has a side below min_size_px or less than half of the full window
/// remains. Source: Shalal et al. 2013, section 4.2 and figure 12.
std::optional<PixelRect> window_around(double x_px, double y_px, double depth_m, double width_m,
                                       double height_m, double focal_x_px, double focal_y_px,
                                       const PixelRect& picture, int min_size_px);

/// Sharpness of an image, independent of its contrast.
struct Sharpness {
  /// Square root of gradient energy over variance of the brightness [1/px]: 2 pi / L for a wave of
  /// length L px; any blur lowers it. Corrected for codec and sensor noise of one grey level. 0 for
  /// a uniform area.
  double detail_per_px = 0.0;
  double clipped_fraction = 0.0;  ///< fraction of pixels that are all black or all white
};

/// Measures the sharpness of a block. All 0 for blocks less than 5 pixels wide or high.
Sharpness sharpness(const PixelBlock& block);

enum class JpegTransform {
  kFast,
  kExact,  ///< as most encoders do by default; a third slower
};

/// Encodes a block as JPEG with the given quality (1 to 100) and 4:2:0 chroma subsampling. Equal
/// pixels give equal bytes on the same machine. Empty if the block is empty.
std::vector<std::uint8_t> write_jpeg(const PixelBlock& block, int quality,
                                     JpegTransform transform = JpegTransform::kFast);

/// Reduces a block by `divisor` in both directions; each pixel is the mean of the pixels that it
/// replaces. Remaining columns at the right and rows at the bottom are dropped. `area` keeps the
/// coordinates of the original image.
PixelBlock shrunk(const PixelBlock& block, int divisor);

}  // namespace orchard::vision
