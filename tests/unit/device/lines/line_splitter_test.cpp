// SPDX-License-Identifier: BSD-3-Clause
#include "device/lines/line_splitter.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace orchard::device {
namespace {

std::vector<std::string> split(LineSplitter& splitter, const std::vector<std::string>& pieces) {
  std::vector<std::string> lines;
  for (const std::string& piece : pieces) {
    splitter.add(piece, [&lines](std::string_view line) { lines.emplace_back(line); });
  }
  return lines;
}

TEST(LineSplitter, EndsLinesAtAnyEnd) {
  LineSplitter splitter(10);
  EXPECT_EQ(split(splitter, {"one\ntw", "o\r\nthree\r", "\n\nfour"}),
            (std::vector<std::string>{"one", "two", "three"}));
}

TEST(LineSplitter, DropsAndCountsWhatIsTooLong) {
  LineSplitter splitter(5);
  EXPECT_EQ(split(splitter, {"12345\n123", "456", "789\nab\n"}),
            (std::vector<std::string>{"12345", "ab"}));
  EXPECT_EQ(splitter.num_too_long(), 1);
}

TEST(LineSplitter, SkipsTheHalfLineItJoinsIn) {
  LineSplitter splitter(20);
  split(splitter, {"half"});
  splitter.restart(true);
  EXPECT_EQ(split(splitter, {"e\nwhole\n"}), std::vector<std::string>{"whole"});
  splitter.restart(false);
  EXPECT_EQ(split(splitter, {"whole\n"}), std::vector<std::string>{"whole"});
}

TEST(LineSplitter, TheSizeOfPiecesDoesNotMatter) {
  std::mt19937 random(7);
  std::string text;
  for (int i = 0; i < 2000; ++i) text += "a\nbc\r"[random() % 5];
  LineSplitter whole(6);
  const auto expected = split(whole, {text});
  for (int run = 0; run < 20; ++run) {
    std::vector<std::string> pieces;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t size = 1 + random() % 9;
      pieces.push_back(text.substr(at, size));
      at += size;
    }
    LineSplitter splitter(6);
    EXPECT_EQ(split(splitter, pieces), expected);
    EXPECT_EQ(splitter.num_too_long(), whole.num_too_long());
  }
}

}  // namespace
}  // namespace orchard::device
