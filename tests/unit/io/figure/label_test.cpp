// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "io/figure/canvas.hpp"
#include "io/figure/plot_axes.hpp"

namespace orchard::io {
namespace {

TEST(DrawnText, KeepsWhatTheFontHas) {
  for (const char* text :
       {"Row 12 <&>", "Secci\xC3\xB3n del tronco, cm\xC2\xB2", "\xE2\x80\x93 \xE2\x89\xA5 0.5"}) {
    EXPECT_EQ(drawn_text(text), text);
  }
}

TEST(DrawnText, WhatIsNoTextIsAQuestionMark) {
  EXPECT_EQ(drawn_text("a\nb\tc\x7F"), "a?b?c?");
  EXPECT_EQ(drawn_text("\xFF\xC3 "), "?? ") << "no UTF-8";
  EXPECT_EQ(drawn_text("\xC3"), "?") << "cut off";
  EXPECT_EQ(drawn_text("\xC0\xAF\xE0\x80\xAF"), "?????") << "longer than need be";
  EXPECT_EQ(drawn_text("\xED\xA0\x80"), "?") << "half a pair";
  EXPECT_EQ(drawn_text("\xE2\x80\xAE"), "?") << "turns the direction of reading";
  EXPECT_EQ(drawn_text("\xF0\x9F\x8C\xB3"), "?") << "a picture";
}

constexpr PixelBox kPage{10.0, 20.0, 410.0, 320.0};

bool overlap(const PixelBox& a, const PixelBox& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

PixelBox box_of(PixelPoint centre, double width, double height) {
  return {centre.x - 0.5 * width, centre.y - 0.5 * height, centre.x + 0.5 * width,
          centre.y + 0.5 * height};
}

TEST(LabelPlacement, GoesToTheRightFirstAndToTheLeftAtThePagesEdge) {
  LabelPlacement placement(kPage);
  const auto free = placement.place({200.0, 100.0}, 6.0, 20.0, 10.0);
  ASSERT_TRUE(free);
  EXPECT_DOUBLE_EQ(free->x, 200.0 + 6.0 + 3.0 + 10.0);
  EXPECT_DOUBLE_EQ(free->y, 100.0);
  const auto at_edge = placement.place({400.0, 100.0}, 6.0, 20.0, 10.0);
  ASSERT_TRUE(at_edge);
  EXPECT_DOUBLE_EQ(at_edge->x, 400.0 - 6.0 - 3.0 - 10.0);
  EXPECT_FALSE(placement.place({200.0, 200.0}, 6.0, 500.0, 10.0)) << "wider than the page";
}

TEST(LabelPlacement, OfACrowdNoTwoOverlapAndNoneLeavesThePage) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(0.0, 420.0), y(10.0, 330.0);
  constexpr double kWidth = 22.0, kHeight = 10.0, kRadius = 3.0;
  LabelPlacement placement(kPage);
  std::vector<PixelPoint> signs;
  std::vector<PixelBox> taken;
  for (int i = 0; i < 400; ++i) {
    signs.push_back({x(random), y(random)});
    const PixelPoint& s = signs.back();
    taken.push_back({s.x - kRadius, s.y - kRadius, s.x + kRadius, s.y + kRadius});
    placement.take(taken.back());
  }
  int num_placed = 0;
  for (const PixelPoint& sign : signs) {
    const auto centre = placement.place(sign, kRadius, kWidth, kHeight);
    if (!centre) continue;
    ++num_placed;
    const PixelBox box = box_of(*centre, kWidth, kHeight);
    for (const PixelBox& other : taken) EXPECT_FALSE(overlap(box, other));
    EXPECT_GE(box.x0, kPage.x0);
    EXPECT_LE(box.x1, kPage.x1);
    EXPECT_GE(box.y0, kPage.y0);
    EXPECT_LE(box.y1, kPage.y1);
    taken.push_back(box);
  }
  EXPECT_GT(num_placed, 60);
  EXPECT_LT(num_placed, 300) << "400 do not fit on the page";
}

}  // namespace
}  // namespace orchard::io
