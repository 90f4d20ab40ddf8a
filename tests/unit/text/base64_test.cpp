// SPDX-License-Identifier: BSD-3-Clause
#include "text/base64.hpp"

#include <gtest/gtest.h>

namespace orchard {
namespace {

std::string of(const std::string& text) {
  return base64_text(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

TEST(Base64, IsThatOfRfc4648) {  // section 10
  EXPECT_EQ(of(""), "");
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foo"), "Zm9v");
  EXPECT_EQ(of("foob"), "Zm9vYg==");
  EXPECT_EQ(of("fooba"), "Zm9vYmE=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(of("\xFF\xFE\xFD"), "//79");
}

}  // namespace
}  // namespace orchard
