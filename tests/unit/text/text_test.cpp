// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <random>
#include <set>

#include "text/date_problem.hpp"
#include "text/encoded_text.hpp"
#include "text/number_text.hpp"

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

TEST(DateText, IsTheDayThatTheCLibraryNames) {
  for (std::int64_t day = 3653; day < 84000; day += 13) {  // 1980 to 2199
    for (const std::int64_t second : {0, 86399}) {
      const std::time_t time = static_cast<std::time_t>(86400 * day + second);
      std::tm utc{};
      ::gmtime_r(&time, &utc);
      char text[16];
      std::strftime(text, sizeof(text), "%Y-%m-%d", &utc);
      ASSERT_EQ(date_text(1000000 * static_cast<std::int64_t>(time)), text);
    }
  }
}

TEST(DateText, AClockThatCountsFromElsewhereNamesNoDay) {
  for (const std::int64_t utime :
       {std::numeric_limits<std::int64_t>::min(), std::int64_t{-1}, std::int64_t{0},
        std::int64_t{3600000000}, std::numeric_limits<std::int64_t>::max()}) {
    EXPECT_EQ(date_text(utime), "");
  }
}

TEST(DateProblem, IsNoneForTheDaysOfTheCalendarAlone) {
  std::set<std::string> days;
  for (std::int64_t day = 0; day < 366 * 231; ++day) {
    days.insert(date_text(day * 86400LL * 1000000LL));
  }
  for (int year = 1970; year < 2210; ++year) {
    for (int month = 0; month <= 13; ++month) {
      for (int day = 0; day <= 32; ++day) {
        char text[32];
        std::snprintf(text, sizeof(text), "%04d-%02d-%02d", year, month, day);
        ASSERT_EQ(date_problem(text).empty(), days.count(text) == 1) << text;
      }
    }
  }
}

TEST(DateProblem, SaysWhatToWriteInstead) {
  EXPECT_EQ(date_problem("2026-4-30"), "is not a date as it is sorted; write 2026-04-30");
  EXPECT_EQ(date_problem("2026-04-030"), "is not a date as it is sorted; write 2026-04-30");
  for (const char* text : {"", "soon", "-", "--", "2026", "2026-04", "2026-04-30 ", "30.4.2026",
                           "2026-04-30-1", "2026-13-45", "2026-02-29", "2026-04--3", "26-04-30"}) {
    EXPECT_NE(date_problem(text).find("write it like 2026-04-30"), std::string::npos) << text;
  }
}

TEST(WholeNumber, IsTheWholeTextOrNone) {
  EXPECT_EQ(whole_number("17"), 17);
  EXPECT_EQ(whole_number("-3"), -3);
  EXPECT_EQ(whole_number("2147483647"), 2147483647);
  for (const char* text : {"", " 1", "1 ", "+1", "1.0", "0x1", "2147483648", "1e3", "a"}) {
    EXPECT_FALSE(whole_number(text)) << '"' << text << '"';
  }
}

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

TEST(MarkupText, NoTextOpensATagOrEndsAnAttribute) {
  EXPECT_EQ(markup_text("<b a=\"x\">"), "&lt;b a=&quot;x&quot;&gt;");
}

TEST(MarkupText, WhatIsEscapedAlreadyIsTextToo) { EXPECT_EQ(markup_text("&lt;"), "&amp;lt;"); }

TEST(MarkupText, AllElseStays) { EXPECT_EQ(markup_text("Año 3/14'"), "Año 3/14'"); }

TEST(PrintableText, LeavesNothingThatSteersATerminal) {
  EXPECT_EQ(printable_text("a\033[31mb\r\n\x7F"), "a?[31mb???");
  EXPECT_EQ(printable_text("a\xC2\x9B"
                           "31m"),
            "a??31m")
      << "CSI as UTF-8";
  EXPECT_EQ(printable_text("a\x9B"
                           "31m"),
            "a?31m")
      << "CSI as one byte";
}

TEST(PrintableText, LeavesWordsAsTheyAre) {
  EXPECT_EQ(printable_text("Apfelb\xC3\xA4ume \xE6\x9E\x97"), "Apfelb\xC3\xA4ume \xE6\x9E\x97");
}

}  // namespace
}  // namespace orchard
