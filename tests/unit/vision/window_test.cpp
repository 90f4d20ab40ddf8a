// SPDX-License-Identifier: BSD-3-Clause
#include "vision/window.hpp"

#include <gtest/gtest.h>

#include <limits>

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

}  // namespace
}  // namespace orchard::vision
