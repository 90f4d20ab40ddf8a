// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Computes the window of a given size in metres around a projected point, clipped to the image.
/// Pixels = focal length x metres / depth, so its size is inversely proportional to range.
///
/// None if the clipped window has a side below min_size_px or less than half of the full window
/// remains. Source: Shalal et al. 2013, section 4.2 and figure 12.
std::optional<PixelRect> window_around(double x_px, double y_px, double depth_m, double width_m,
                                       double height_m, double focal_x_px, double focal_y_px,
                                       const PixelRect& picture, int min_size_px);

}  // namespace orchard::vision
