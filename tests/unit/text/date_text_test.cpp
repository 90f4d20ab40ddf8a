// SPDX-License-Identifier: BSD-3-Clause
#include "text/date_text.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <limits>

namespace orchard {
namespace {

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

}  // namespace
}  // namespace orchard
