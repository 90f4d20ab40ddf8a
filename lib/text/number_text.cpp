// SPDX-License-Identifier: BSD-3-Clause
#include "text/number_text.hpp"

#include <fmt/core.h>

#include <charconv>

#include "text/parse_number.hpp"

namespace orchard {
namespace {

constexpr std::int64_t kDay_us = 86400LL * 1000000LL;
constexpr int kFirstYear = 1980, kLastYear = 2200;

bool is_leap(int year) { return (year % 4 == 0 && year % 100 != 0) || year % 400 == 0; }

int days_in(int month, int year) {
  constexpr int kDays[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
  return kDays[month - 1] + (month == 2 && is_leap(year) ? 1 : 0);
}

}  // namespace

std::string fixed_text(double value, int num_decimals) {
  char text[400];  // the largest double has 309 digits before the decimal point
  const auto result =
      std::to_chars(text, text + sizeof(text), value, std::chars_format::fixed, num_decimals);
  std::string fixed(text, result.ptr);
  if (fixed[0] == '-' && fixed.find_first_not_of("-0.") == std::string::npos) fixed.erase(0, 1);
  return fixed;
}

std::string shortest_text(double value) {
  char text[32];
  const auto result = std::to_chars(text, text + sizeof(text), value);
  return std::string(text, result.ptr);
}

std::optional<std::int32_t> whole_number(std::string_view text) {
  return parse_number<std::int32_t>(text);
}

std::string date_text(std::int64_t utime) {
  if (utime < 0) return {};
  std::int64_t day = utime / kDay_us;
  int year = 1970;
  for (; year <= kLastYear && day >= (is_leap(year) ? 366 : 365); ++year) {
    day -= is_leap(year) ? 366 : 365;
  }
  if (year < kFirstYear || year > kLastYear) return {};
  int month = 1;
  for (; day >= days_in(month, year); ++month) day -= days_in(month, year);
  return fmt::format("{:04}-{:02}-{:02}", year, month, static_cast<int>(day) + 1);
}

}  // namespace orchard
