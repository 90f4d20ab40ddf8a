// SPDX-License-Identifier: BSD-3-Clause
#include "vision/pixel_block.hpp"

#include <cmath>

namespace orchard::vision {
namespace {

/// derived: larger values could not be added as integers.
constexpr double kMaxSize_px = 1e5;

}  // namespace

std::optional<PixelRect> window_around(double x_px, double y_px, double depth_m, double width_m,
                                       double height_m, double focal_x_px, double focal_y_px,
                                       const PixelRect& picture, int min_size_px) {
  const double width_px = focal_x_px * width_m / depth_m;
  const double height_px = focal_y_px * height_m / depth_m;
  if (!(depth_m > 0.0) || !(width_px >= min_size_px) || !(height_px >= min_size_px) ||
      width_px > kMaxSize_px || height_px > kMaxSize_px || !(std::abs(x_px) <= kMaxSize_px) ||
      !(std::abs(y_px) <= kMaxSize_px)) {
    return std::nullopt;
  }
  PixelRect whole;
  whole.width_px = static_cast<int>(std::lround(width_px));
  whole.height_px = static_cast<int>(std::lround(height_px));
  whole.x_px = static_cast<int>(std::lround(x_px - 0.5 * (whole.width_px - 1)));
  whole.y_px = static_cast<int>(std::lround(y_px - 0.5 * (whole.height_px - 1)));
  const PixelRect clipped = intersection(whole, picture);
  if (clipped.width_px < min_size_px || clipped.height_px < min_size_px ||
      2.0 * clipped.width_px * clipped.height_px < 1.0 * whole.width_px * whole.height_px) {
    return std::nullopt;
  }
  return clipped;
}

}  // namespace orchard::vision
