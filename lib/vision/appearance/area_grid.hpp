// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace orchard::vision {

/// Resamples an image (CV_8UC3) to a small grid (CV_32FC3, in grey levels) whose cells are the mean
/// of the area that they cover. Equals cv::resize() of the floating-point image with INTER_AREA,
/// but is much faster, because rows are summed before columns. Images smaller than the grid are
/// passed to cv::resize().
cv::Mat area_grid(const cv::Mat& pixels, int rows, int cols);

}  // namespace orchard::vision
