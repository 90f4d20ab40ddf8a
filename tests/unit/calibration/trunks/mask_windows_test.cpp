// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/trunks/mask_windows.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace orchard::calibration {
namespace {

/// A trunk of 20 columns that leans to the right.
TrunkMask leaning_trunk() {
  TrunkMask mask{200, 300, std::vector<std::uint8_t>(200 * 300, 0)};
  for (std::size_t y = 30; y < 280; ++y) {
    for (std::size_t x = 0; x < 20; ++x) mask.trunk[y * 200 + 70 + y / 10 + x] = 1;
  }
  return mask;
}

double trunk_fraction(const TrunkMask& mask, const vision::PixelRect& w) {
  double sum = 0.0;
  for (int y = w.y_px; y < w.y_px + w.height_px; ++y) {
    for (int x = w.x_px; x < w.x_px + w.width_px; ++x) {
      sum += mask.trunk[static_cast<std::size_t>(y * mask.width_px + x)];
    }
  }
  return sum / (w.width_px * w.height_px);
}

TEST(MaskWindows, LieOnTheTrunkAndElsewhereAtTheSameHeights) {
  const TrunkMask mask = leaning_trunk();
  const auto windows = sample_windows(mask, {});
  ASSERT_EQ(windows.size(), 120u);
  for (std::size_t i = 0; i < windows.size(); i += 2) {
    const LabelledWindow &on = windows[i], &off = windows[i + 1];
    EXPECT_TRUE(on.is_trunk);
    EXPECT_FALSE(off.is_trunk);
    EXPECT_TRUE((vision::PixelRect{0, 0, 200, 300}).contains(on.window));
    EXPECT_TRUE((vision::PixelRect{0, 0, 200, 300}).contains(off.window));
    EXPECT_GT(trunk_fraction(mask, on.window), 0.5);
    EXPECT_EQ(trunk_fraction(mask, off.window), 0.0);
    EXPECT_EQ(on.window.y_px, off.window.y_px);
    EXPECT_EQ(on.window.width_px, off.window.width_px);
    EXPECT_EQ(on.window.height_px, off.window.height_px);
    EXPECT_NEAR(on.window.width_px, 20, 4);
  }
}

TEST(MaskWindows, FollowFromTheSeed) {
  const TrunkMask mask = leaning_trunk();
  MaskWindowOptions options;
  const auto a = sample_windows(mask, options), b = sample_windows(mask, options);
  options.seed = 2;
  const auto c = sample_windows(mask, options);
  ASSERT_EQ(a.size(), b.size());
  int differing = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].window.x_px, b[i].window.x_px);
    differing += a[i].window.x_px != c[i].window.x_px || a[i].window.y_px != c[i].window.y_px;
  }
  EXPECT_GT(differing, 100);
}

TEST(MaskWindows, AreOfTheWantedShape) {
  MaskWindowOptions options;
  options.aspect_min = options.aspect_max = 4.0;
  options.scatter = 0.0;
  options.width_scale = 0.5;
  options.per_class = 7;
  const auto windows = sample_windows(leaning_trunk(), options);
  ASSERT_EQ(windows.size(), 14u);
  for (const LabelledWindow& w : windows) {
    EXPECT_EQ(w.window.width_px, 10);
    EXPECT_EQ(w.window.height_px, 40);
  }
}

TEST(MaskWindows, NoneWhereThereIsNoTrunkOrNoRoom) {
  const TrunkMask empty{50, 50, std::vector<std::uint8_t>(2500, 0)};
  EXPECT_TRUE(sample_windows(empty, {}).empty());
  const TrunkMask full{50, 50, std::vector<std::uint8_t>(2500, 1)};
  EXPECT_TRUE(sample_windows(full, {}).empty());
  EXPECT_TRUE(sample_windows(TrunkMask(), {}).empty());
  EXPECT_THROW(sample_windows({50, 50, {}}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace orchard::calibration
