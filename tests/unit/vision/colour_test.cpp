// SPDX-License-Identifier: BSD-3-Clause
#include "vision/colour.hpp"

#include <gtest/gtest.h>

#include "unit/vision/test_pictures.hpp"

namespace orchard::vision {
namespace {

using test::bgr_of;
using test::block_of;

cv::Mat plain(double hue_deg, double saturation = 0.5, double value = 0.7) {
  return cv::Mat(20, 10, CV_8UC3, cv::Scalar(bgr_of(hue_deg, saturation, value)));
}

ColourEvidence judge(const cv::Mat& picture, const ColourConfig& config = {}) {
  const PixelRect window{0, 0, picture.cols, picture.rows};
  return colour_confidence(hue_histogram(block_of(picture), window), config);
}

TEST(Colour, ATrunksColourPassesInFull) {
  const ColourEvidence evidence = judge(plain(30.0));
  EXPECT_NEAR(evidence.dominant_hue_deg, 30.0, 2.0);
  EXPECT_TRUE(evidence.passed);
  EXPECT_DOUBLE_EQ(evidence.roc, 1.0);
}

TEST(Colour, AnotherColourFailsAndHasNoRoc) {
  const ColourEvidence evidence = judge(plain(210.0));
  EXPECT_NEAR(evidence.dominant_hue_deg, 210.0, 2.0);
  EXPECT_FALSE(evidence.passed);
  EXPECT_EQ(evidence.roc, 0.0);
}

TEST(Colour, RocIsTheFractionOfTheWindowWithATrunksHue) {
  cv::Mat picture = plain(30.0);
  picture.rowRange(0, 5) = cv::Scalar(bgr_of(210.0, 0.5, 0.7));   // another colour
  picture.rowRange(5, 8) = cv::Scalar(bgr_of(30.0, 0.02, 0.7));   // too pale
  picture.rowRange(8, 10) = cv::Scalar(bgr_of(30.0, 0.5, 0.04));  // too dark
  EXPECT_DOUBLE_EQ(judge(picture).roc, 0.5);
}

TEST(Colour, GreyAndBlackHaveNoHue) {
  EXPECT_FALSE(judge(plain(30.0, 0.0)).passed);
  EXPECT_FALSE(judge(plain(30.0, 0.5, 0.0)).passed);
}

TEST(Colour, TheIntervalIsCircular) {
  EXPECT_TRUE(hue_in_range(355.0, 350.0, 20.0));
  EXPECT_TRUE(hue_in_range(5.0, 350.0, 20.0));
  EXPECT_FALSE(hue_in_range(30.0, 350.0, 20.0));
  EXPECT_FALSE(hue_in_range(340.0, 350.0, 20.0));
  EXPECT_TRUE(hue_in_range(30.0, 30.0, 30.0));
  ColourConfig reds;
  reds.hue_min_deg = 350.0;
  reds.hue_max_deg = 20.0;
  EXPECT_TRUE(judge(plain(356.0), reds).passed);
  EXPECT_TRUE(judge(plain(6.0), reds).passed);
  EXPECT_FALSE(judge(plain(60.0), reds).passed);
}

TEST(Colour, TheDominantHueIsTheFullestBinsMean) {
  HueHistogram histogram;
  histogram.counts[10] = 3;  // 20 degrees
  histogram.counts[11] = 3;  // 22 degrees, same bin of 10 degrees
  histogram.counts[100] = 5;
  EXPECT_DOUBLE_EQ(dominant_hue_deg(histogram, 36), 21.0);
  EXPECT_DOUBLE_EQ(dominant_hue_deg(histogram, 180), 200.0);
  EXPECT_THROW(dominant_hue_deg(histogram, 0), std::invalid_argument);
}

TEST(Colour, EqualsOpenCvOverTheWholePicture) {
  const cv::Mat picture = test::busy_picture(120, 90, 9);
  const PixelRect window{31, 17, 40, 50};
  const HueHistogram histogram = hue_histogram(block_of(picture), window);
  cv::Mat hsv;
  cv::cvtColor(picture, hsv, cv::COLOR_BGR2HSV);
  std::array<int, kNumHues> counts{};
  for (int y = 17; y < 67; ++y) {
    for (int x = 31; x < 71; ++x) {
      const auto pixel = hsv.at<cv::Vec3b>(y, x);
      if (pixel[1] >= 25.5 && pixel[2] >= 25.5) ++counts[pixel[0]];
    }
  }
  EXPECT_EQ(histogram.counts, counts);
  EXPECT_EQ(histogram.num_pixels, 2000);
}

TEST(Colour, RefusesAWindowOutsideItsPixels) {
  EXPECT_THROW(hue_histogram(block_of(plain(30.0)), {5, 5, 10, 10}), std::invalid_argument);
}

}  // namespace
}  // namespace orchard::vision
