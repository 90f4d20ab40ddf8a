// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance/area_grid.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace orchard::vision {
namespace {

/// Largest difference to what OpenCV makes of the same picture, and how many values differ.
std::pair<double, int> difference(const cv::Mat& pixels, int rows, int cols) {
  cv::Mat truth, off;
  cv::resize(pixels, truth, {cols, rows}, 0, 0, cv::INTER_AREA);
  cv::absdiff(area_grid(pixels, rows, cols), truth, off);
  return {cv::norm(off, cv::NORM_INF), cv::countNonZero(off.reshape(1))};
}

TEST(AreaGrid, IsTheMeanOverEachCellAsOpenCvHasIt) {
  cv::RNG random(7);
  int num_values = 0;
  int num_different = 0;
  for (int i = 0; i < 300; ++i) {
    cv::Mat whole(random.uniform(4, 130), random.uniform(4, 90), CV_8UC3);
    random.fill(whole, cv::RNG::UNIFORM, 0, 256);
    // a part of a picture, whose rows do not follow each other in memory
    const cv::Mat pixels = whole(cv::Rect(1, 1, whole.cols - 2, whole.rows - 2));
    const auto [most, different] = difference(pixels, 16, 8);
    EXPECT_LE(most, 1.0) << pixels.rows << " x " << pixels.cols;  // a tie, rounded otherwise
    num_values += 16 * 8 * 3;
    num_different += different;
  }
  EXPECT_LT(num_different, num_values / 500);
}

TEST(AreaGrid, AFractionOfAPixelCountsByItsFraction) {
  // Three columns on two cells: the middle one belongs to both by halves.
  cv::Mat pixels(1, 3, CV_8UC3);
  pixels.at<cv::Vec3b>(0, 0) = {0, 30, 90};
  pixels.at<cv::Vec3b>(0, 1) = {60, 60, 60};
  pixels.at<cv::Vec3b>(0, 2) = {120, 0, 30};
  const cv::Mat grid = area_grid(pixels, 1, 2);
  EXPECT_EQ(grid.at<cv::Vec3b>(0, 0), cv::Vec3b(20, 40, 80));
  EXPECT_EQ(grid.at<cv::Vec3b>(0, 1), cv::Vec3b(100, 20, 40));
}

}  // namespace
}  // namespace orchard::vision
