// SPDX-License-Identifier: BSD-3-Clause
#include "vision/canny.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace orchard::vision {
namespace {

/// Noise, smoothed so that edges of every direction and strength are among it.
cv::Mat texture(int width_px, int height_px, double blur_px, cv::RNG& random) {
  cv::Mat grey(height_px, width_px, CV_8UC1);
  random.fill(grey, cv::RNG::UNIFORM, 0, 256);
  if (blur_px > 0.0) cv::GaussianBlur(grey, grey, {0, 0}, blur_px);
  cv::normalize(grey, grey, 0, 255, cv::NORM_MINMAX);
  return grey;
}

void expect_opencvs_edges(const cv::Mat& grey, double low, double high) {
  cv::Mat expected;
  cv::Canny(grey, expected, low, high);
  const std::vector<std::uint8_t> edges = canny(grey.data, grey.cols, grey.rows, low, high);
  ASSERT_EQ(edges.size(), expected.total());
  EXPECT_TRUE(std::equal(edges.begin(), edges.end(), expected.data))
      << grey.cols << " x " << grey.rows << ", thresholds " << low << " and " << high;
}

TEST(Canny, EqualsOpenCvOnTextureOfEverySize) {
  cv::RNG random(5);
  for (int i = 0; i < 400; ++i) {
    const cv::Mat grey =
        texture(random.uniform(1, 70), random.uniform(1, 50), 0.7 * random.uniform(0, 5), random);
    const double low = random.uniform(1.0, 200.0);
    expect_opencvs_edges(grey, low, low + random.uniform(0.0, 300.0));
  }
}

TEST(Canny, EqualsOpenCvOnAWholePicture) {
  cv::RNG random(6);
  const cv::Mat grey = texture(640, 480, 2.0, random);
  for (const double low : {1.0, 15.5, 40.0, 1000.0}) {
    expect_opencvs_edges(grey, low, 2.5 * low);
  }
}

TEST(Canny, TheStrongestGradientsDoNotOverflow) {
  cv::RNG random(7);
  cv::Mat black_and_white = texture(61, 47, 1.0, random) > 127;
  expect_opencvs_edges(black_and_white, 1.0, 2.0);
  expect_opencvs_edges(black_and_white, 900.0, 1100.0);
  expect_opencvs_edges(black_and_white, 2000.0, 5000.0);
}

TEST(Canny, NoPictureHasNoEdges) { EXPECT_TRUE(canny(nullptr, 0, 0, 10.0, 20.0).empty()); }

}  // namespace
}  // namespace orchard::vision
