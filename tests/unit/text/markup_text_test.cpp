// SPDX-License-Identifier: BSD-3-Clause
#include "text/markup_text.hpp"

#include <gtest/gtest.h>

namespace orchard {
namespace {

TEST(MarkupText, NoTextOpensATagOrEndsAnAttribute) {
  EXPECT_EQ(markup_text("<b a=\"x\">"), "&lt;b a=&quot;x&quot;&gt;");
}

TEST(MarkupText, WhatIsEscapedAlreadyIsTextToo) { EXPECT_EQ(markup_text("&lt;"), "&amp;lt;"); }

TEST(MarkupText, AllElseStays) { EXPECT_EQ(markup_text("Año 3/14'"), "Año 3/14'"); }

}  // namespace
}  // namespace orchard
