// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Private to this module: it includes OpenCV.
#include <cstdint>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "vision/pixel_block.hpp"

namespace orchard::vision {

/// Views a window of a block as a cv::Mat without copying (8UC3, read-only). Throws
/// std::invalid_argument when the window is empty or does not lie inside the block.
inline cv::Mat view_of(const PixelBlock& pixels, const PixelRect& window) {
  if (window.empty() || !pixels.area.contains(window)) {
    throw std::invalid_argument("the window does not lie inside the decoded pixels");
  }
  const std::size_t stride = 3u * static_cast<std::size_t>(pixels.area.width_px);
  const std::uint8_t* first = pixels.bgr.data() +
                              stride * static_cast<std::size_t>(window.y_px - pixels.area.y_px) +
                              3u * static_cast<std::size_t>(window.x_px - pixels.area.x_px);
  return {window.height_px, window.width_px, CV_8UC3, const_cast<std::uint8_t*>(first), stride};
}

/// Resamples an image (CV_8UC3) to a small grid (CV_32FC3, in grey levels) whose cells are the mean
/// of the area that they cover. Equals cv::resize() of the floating-point image with INTER_AREA,
/// but is much faster, because rows are summed before columns. Images smaller than the grid are
/// passed to cv::resize().
cv::Mat area_grid(const cv::Mat& pixels, int rows, int cols);

}  // namespace orchard::vision
