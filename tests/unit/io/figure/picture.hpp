// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"

namespace orchard::io {

inline cv::Mat decoded(const std::string& png) {
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_COLOR);
}

/// Where pixels have exactly that colour: 255, elsewhere 0.
inline cv::Mat pixels_of(const cv::Mat& picture, Colour c) {
  cv::Mat mask;
  cv::inRange(picture, cv::Scalar(c.b, c.g, c.r), cv::Scalar(c.b, c.g, c.r), mask);
  return mask;
}

/// An area of one colour.
struct Spot {
  double x, y;  ///< its centre; the middle of the first pixel is 0.5
  double area;
  cv::Rect box;
};

/// The spots of that colour of at least so many pixels, from left to right.
inline std::vector<Spot> spots_of(const cv::Mat& picture, Colour colour, int num_pixels_min) {
  cv::Mat labels, stats, centres;
  const int num =
      cv::connectedComponentsWithStats(pixels_of(picture, colour), labels, stats, centres);
  std::vector<Spot> spots;
  for (int i = 1; i < num; ++i) {
    const int area = stats.at<int>(i, cv::CC_STAT_AREA);
    if (area < num_pixels_min) continue;
    spots.push_back({centres.at<double>(i, 0) + 0.5,
                     centres.at<double>(i, 1) + 0.5,
                     1.0 * area,
                     {stats.at<int>(i, cv::CC_STAT_LEFT), stats.at<int>(i, cv::CC_STAT_TOP),
                      stats.at<int>(i, cv::CC_STAT_WIDTH), stats.at<int>(i, cv::CC_STAT_HEIGHT)}});
  }
  std::sort(spots.begin(), spots.end(), [](const Spot& a, const Spot& b) { return a.x < b.x; });
  return spots;
}

}  // namespace orchard::io
