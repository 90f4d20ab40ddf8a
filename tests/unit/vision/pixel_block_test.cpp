// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "vision/pixel_block.hpp"

namespace orchard::vision {
namespace {

constexpr PixelRect kPicture{0, 0, 320, 240};

std::optional<PixelRect> at(double x_px, double y_px, double depth_m) {
  return window_around(x_px, y_px, depth_m, 0.06, 0.20, 250.0, 250.0, kPicture, 4);
}

TEST(Window, IsInverselyProportionalToRange) {
  const auto near = at(160, 120, 1.0), far = at(160, 120, 2.0);
  ASSERT_TRUE(near && far);
  EXPECT_EQ(near->width_px, 15);
  EXPECT_EQ(near->height_px, 50);
  EXPECT_NEAR(far->width_px, 7.5, 0.5);
  EXPECT_EQ(far->height_px, 25);
}

TEST(Window, IsCentred) {
  const auto window = at(100, 120, 1.0);  // 15 columns: 93 to 107
  ASSERT_TRUE(window.has_value());
  EXPECT_EQ(window->x_px, 93);
}

TEST(Window, IsClippedAtTheBorderAndNoneBeyondHalf) {
  const auto window = at(4, 120, 1.0);
  ASSERT_TRUE(window.has_value());
  EXPECT_EQ(window->x_px, 0);
  EXPECT_EQ(window->width_px, 12);
  EXPECT_FALSE(at(-2, 120, 1.0).has_value());
}

TEST(Window, IsNoneWhenTooSmallOrSenseless) {
  EXPECT_FALSE(at(160, 120, 10.0).has_value());
  EXPECT_FALSE(at(160, 120, 0.0).has_value());
  EXPECT_FALSE(at(160, 120, -1.0).has_value());
  EXPECT_FALSE(at(std::numeric_limits<double>::quiet_NaN(), 120, 1.0).has_value());
  EXPECT_FALSE(at(1e300, 120, 1.0).has_value());
  EXPECT_FALSE(at(160, 120, 1e-300).has_value());
}

PixelBlock block_of(int width_px, int height_px, const std::function<double(int, int)>& grey) {
  PixelBlock block;
  block.area = {0, 0, width_px, height_px};
  for (int y = 0; y < height_px; ++y) {
    for (int x = 0; x < width_px; ++x) {
      const auto value = static_cast<std::uint8_t>(std::lround(grey(x, y)));
      block.bgr.insert(block.bgr.end(), 3, value);
    }
  }
  return block;
}

PixelBlock wave(double length_px, double amplitude) {
  return block_of(120, 60, [=](int x, int) {
    return 128.0 + amplitude * std::sin(2.0 * M_PI * x / length_px);
  });
}

TEST(Sharpness, OfAWaveIsItsFrequencyWhateverItsContrast) {
  for (const double length_px : {12.0, 20.0, 40.0}) {
    for (const double amplitude : {40.0, 100.0}) {
      EXPECT_NEAR(sharpness(wave(length_px, amplitude)).detail_per_px, 2.0 * M_PI / length_px,
                  0.06 * 2.0 * M_PI / length_px)
          << length_px << " " << amplitude;
    }
  }
}

TEST(Sharpness, BlurLowersIt) {
  double before = 1e9;
  for (const double blur_px : {0.5, 1.0, 2.0, 4.0}) {  // a trunk's side, ever softer
    const double detail = sharpness(block_of(60, 60, [=](int x, int) {
                            return 128.0 + 80.0 * std::tanh((x - 30.0) / blur_px);
                          })).detail_per_px;
    EXPECT_LT(detail, before) << blur_px;
    before = detail;
  }
}

TEST(Sharpness, AnEvenAreaAndATinyOneShowNothing) {
  EXPECT_EQ(sharpness(block_of(40, 40, [](int, int) { return 90.0; })).detail_per_px, 0.0);
  EXPECT_EQ(sharpness(block_of(4, 40, [](int x, int) { return 60.0 * x; })).detail_per_px, 0.0);
  EXPECT_EQ(sharpness(PixelBlock{}).clipped_fraction, 0.0);
}

TEST(Sharpness, CountsWhatIsBlackOrWhite) {
  const auto block = block_of(40, 40, [](int x, int) {
    return x < 10 ? 0.0 : x < 20 ? 255.0 : 100.0;
  });
  EXPECT_DOUBLE_EQ(sharpness(block).clipped_fraction, 0.5);
}

TEST(JpegWriter, WritesWhatItIsGiven) {
  const PixelBlock block = wave(30.0, 60.0);
  const auto jpeg = write_jpeg(block, 90);
  EXPECT_EQ(jpeg, write_jpeg(block, 90));
  EXPECT_GT(jpeg.size(), write_jpeg(block, 40).size());
  const cv::Mat read = cv::imdecode(jpeg, cv::IMREAD_COLOR);
  ASSERT_EQ(read.size(), cv::Size(120, 60));
  for (int x = 0; x < 120; ++x) {
    EXPECT_NEAR(read.at<cv::Vec3b>(30, x)[1], block.bgr[3u * (30u * 120u + unsigned(x))], 12);
  }
  EXPECT_TRUE(write_jpeg({}, 90).empty());
}

TEST(JpegWriter, ShrinksByMeans) {
  const auto block = block_of(7, 5, [](int x, int y) { return 10.0 * x + y; });
  const PixelBlock small = shrunk(block, 2);
  EXPECT_EQ(small.area.width_px, 3);
  EXPECT_EQ(small.area.height_px, 2);
  ASSERT_EQ(small.bgr.size(), 18u);
  EXPECT_EQ(small.bgr[0], 6);             // 0, 10, 1, 11: 5.5
  EXPECT_EQ(small.bgr[3 * (3 + 2)], 48);  // 42, 52, 43, 53: 47.5
  EXPECT_EQ(shrunk(block, 1).bgr, block.bgr);
}

}  // namespace
}  // namespace orchard::vision
