// SPDX-License-Identifier: BSD-3-Clause
#include "text/number_text.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <random>

namespace orchard {
namespace {

TEST(NumberText, FixedHasItsDecimalsAndNoNegativeZero) {
  EXPECT_EQ(fixed_text(1.005, 2), "1.00");  // the double is below 1.005
  EXPECT_EQ(fixed_text(0.125, 2), "0.12");  // a tie goes to the even digit
  EXPECT_EQ(fixed_text(0.375, 2), "0.38");
  EXPECT_EQ(fixed_text(-0.0004, 3), "0.000");
  EXPECT_EQ(fixed_text(-0.0, 0), "0");
  EXPECT_EQ(fixed_text(-0.0006, 3), "-0.001");
  EXPECT_EQ(fixed_text(std::numeric_limits<double>::max(), 4).size(), 309u + 5u);
}

/// As C's printf writes, which rounds the exact value too.
TEST(NumberText, FixedAndFmtWriteWhatPrintfWrites) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 200000; ++i) {
    const std::uint64_t bits = random();
    double value = 0.0;
    if (i % 2 == 0) {
      std::memcpy(&value, &bits, sizeof value);  // any double
      if (!(std::abs(value) < 1e12 && std::abs(value) > 1e-12)) continue;
    } else {
      value = static_cast<double>(static_cast<std::int64_t>(bits) >> 44) / 1024.0;  // many ties
    }
    const int decimals = static_cast<int>(bits % 7);
    char expected[400];
    std::snprintf(expected, sizeof expected, "%.*f", decimals, value);
    EXPECT_EQ(fmt::format("{:.{}f}", value, decimals), expected);
    if (fixed_text(value, decimals) != expected) {
      EXPECT_EQ("-" + fixed_text(value, decimals), expected) << "but for a negative zero";
      EXPECT_EQ(std::strtod(expected, nullptr), 0.0);
    }
    std::snprintf(expected, sizeof expected, "%.6g|%g", value, value);
    EXPECT_EQ(fmt::format("{:.6g}|{:g}", value, value), expected);
  }
}

TEST(NumberText, ShortestReadsBackAsTheSameNumber) {
  EXPECT_EQ(shortest_text(0.1), "0.1");
  EXPECT_EQ(shortest_text(-2.0), "-2");
  std::mt19937_64 random(2);
  for (int i = 0; i < 10000; ++i) {
    const std::uint64_t bits = random();
    double value = 0.0;
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    EXPECT_EQ(std::strtod(shortest_text(value).c_str(), nullptr), value);
  }
}

TEST(NumberText, TheLocaleDoesNotMatter) {
  bool has_comma = false;
  for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
    if (std::setlocale(LC_NUMERIC, name) != nullptr) has_comma = true;
    if (has_comma) break;
  }
  EXPECT_EQ(fixed_text(1.5, 1), "1.5");
  EXPECT_EQ(shortest_text(1.5), "1.5");
  EXPECT_EQ(fmt::format("{:.1f}", 1.5), "1.5");
  std::setlocale(LC_NUMERIC, "C");
  if (!has_comma) GTEST_SKIP() << "no locale with a decimal comma is installed";
}

}  // namespace
}  // namespace orchard
