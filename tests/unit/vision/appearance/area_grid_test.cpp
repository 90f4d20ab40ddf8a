// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance/area_grid.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace orchard::vision {
namespace {

/// Largest difference to what OpenCV makes of the same picture in floating point.
double difference(const cv::Mat& pixels, int rows, int cols) {
  cv::Mat values, truth;
  pixels.convertTo(values, CV_32FC3);
  cv::resize(values, truth, {cols, rows}, 0, 0, cv::INTER_AREA);
  return cv::norm(area_grid(pixels, rows, cols), truth, cv::NORM_INF);
}

TEST(AreaGrid, IsTheMeanOverEachCellAsOpenCvHasIt) {
  cv::RNG random(7);
  for (int i = 0; i < 300; ++i) {
    cv::Mat whole(random.uniform(4, 130), random.uniform(4, 90), CV_8UC3);
    random.fill(whole, cv::RNG::UNIFORM, 0, 256);
    // a part of a picture, whose rows do not follow each other in memory
    const cv::Mat pixels = whole(cv::Rect(1, 1, whole.cols - 2, whole.rows - 2));
    EXPECT_LT(difference(pixels, 16, 8), 1e-3) << pixels.rows << " x " << pixels.cols;
  }
}

TEST(AreaGrid, AFractionOfAPixelCountsByItsFraction) {
  // Three columns on two cells: the middle one belongs to both by halves.
  cv::Mat pixels(1, 3, CV_8UC3);
  pixels.at<cv::Vec3b>(0, 0) = {0, 30, 90};
  pixels.at<cv::Vec3b>(0, 1) = {60, 60, 60};
  pixels.at<cv::Vec3b>(0, 2) = {120, 0, 30};
  const cv::Mat grid = area_grid(pixels, 1, 2);
  EXPECT_LT(cv::norm(grid.at<cv::Vec3f>(0, 0), cv::Vec3f(20, 40, 80)), 1e-3);
  EXPECT_LT(cv::norm(grid.at<cv::Vec3f>(0, 1), cv::Vec3f(100, 20, 40)), 1e-3);
}

}  // namespace
}  // namespace orchard::vision
