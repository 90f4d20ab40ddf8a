// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/drawn_text.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace orchard::io
