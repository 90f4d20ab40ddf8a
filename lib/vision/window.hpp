// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// The window of a size given in metres around a projected point, clipped to the picture: pixels =
/// focal length x metres / depth, so that its size is inversely proportional to range.
///
/// None when less than min_size_px by min_size_px of it lies in the picture, or less than half of
/// it. Source: Shalal et al. 2013, section 4.2 and figure 12.
std::optional<PixelRect> window_around(double x_px, double y_px, double depth_m, double width_m,
                                       double height_m, double focal_x_px, double focal_y_px,
                                       const PixelRect& picture, int min_size_px);

}  // namespace orchard::vision
