// SPDX-License-Identifier: BSD-3-Clause
#include "farm/sha256.hpp"

#include <gtest/gtest.h>

#include <string>

namespace orchard::farm {
namespace {

// The examples that NIST gives for SHA-256.
TEST(Sha256, GivesTheStandardsDigests) {
  EXPECT_EQ(sha256_hex(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256_hex("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST(Sha256, DoesNotDependOnThePiecesInWhichBytesCome) {
  std::string text;
  for (int i = 0; i < 1000; ++i) text += static_cast<char>((i * 31) % 251);
  for (const std::size_t piece : {1UL, 3UL, 55UL, 63UL, 64UL, 65UL, 999UL}) {
    Sha256 digest;
    for (std::size_t at = 0; at < text.size(); at += piece) {
      digest.add(text.data() + at, std::min(piece, text.size() - at));
    }
    EXPECT_EQ(digest.hex(), sha256_hex(text)) << piece;
  }
}

}  // namespace
}  // namespace orchard::farm
