// SPDX-License-Identifier: BSD-3-Clause
#include "vision/appearance/light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace orchard::vision {
namespace {

PixelBlock block(std::uint8_t blue, std::uint8_t green, std::uint8_t red, int num_pixels = 16) {
  PixelBlock pixels;
  pixels.area = {10, 20, num_pixels, 1};
  for (int i = 0; i < num_pixels; ++i) pixels.bgr.insert(pixels.bgr.end(), {blue, green, red});
  return pixels;
}

TEST(Light, MeasuresTheLogsOfChannels) {
  const auto light = window_light(block(50, 100, 200), {12, 20, 8, 1});
  ASSERT_TRUE(light);
  EXPECT_NEAR(light->blue, std::log(0.5), 1e-12);
  EXPECT_NEAR(light->red, std::log(2.0), 1e-12);
  EXPECT_NEAR(light->green, std::log(100.0), 1e-12);
}

TEST(Light, ClippedAndDarkPixelsTellNothing) {
  EXPECT_FALSE(window_light(block(50, 100, 255), {10, 20, 16, 1}));
  EXPECT_FALSE(window_light(block(0, 100, 200), {10, 20, 16, 1}));
  PixelBlock pixels = block(50, 100, 200);
  for (std::size_t i = 0; i < 3 * 12; i += 3) pixels.bgr[i] = 255;  // a quarter is left
  const auto light = window_light(pixels, pixels.area);
  ASSERT_TRUE(light);
  EXPECT_NEAR(light->blue, std::log(0.5), 1e-12);
  EXPECT_THROW(window_light(pixels, {9, 20, 4, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace orchard::vision
