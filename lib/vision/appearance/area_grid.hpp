// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace orchard::vision {

/// A picture (CV_8UC3) brought down to a grid of a few cells, each the mean of the area that it
/// covers, edges by their fraction: cv::resize() with INTER_AREA to a rounding, in a fraction of
/// its time, as rows are added up before columns. What is smaller than the grid goes to
/// cv::resize().
cv::Mat area_grid(const cv::Mat& pixels, int rows, int cols);

}  // namespace orchard::vision
