// SPDX-License-Identifier: BSD-3-Clause
#include "text/whole_number.hpp"

#include <gtest/gtest.h>

namespace orchard {
namespace {

TEST(WholeNumber, IsTheWholeTextOrNone) {
  EXPECT_EQ(whole_number("17"), 17);
  EXPECT_EQ(whole_number("-3"), -3);
  EXPECT_EQ(whole_number("2147483647"), 2147483647);
  for (const char* text : {"", " 1", "1 ", "+1", "1.0", "0x1", "2147483648", "1e3", "a"}) {
    EXPECT_FALSE(whole_number(text)) << '"' << text << '"';
  }
}

}  // namespace
}  // namespace orchard
