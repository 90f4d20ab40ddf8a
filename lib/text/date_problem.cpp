// SPDX-License-Identifier: BSD-3-Clause
#include "text/date_problem.hpp"

#include <fmt/core.h>

#include "text/number_text.hpp"

namespace orchard {
namespace {

/// Days since 1970-01-01 in the Gregorian calendar, of which a leap day is the last of a year that
/// begins in March (719468 days before 1970 the year 0 did). A day that a month does not have is
/// one of the next month.
std::int64_t days_since_1970(int year, int month, int day) {
  const std::int64_t y = month <= 2 ? year - 1 : year;
  const int month_from_march = (month + 9) % 12;
  return 365 * y + y / 4 - y / 100 + y / 400 + (153 * month_from_march + 2) / 5 + day - 1 - 719468;
}

/// The day as date_text() writes it; empty where the calendar has none.
std::string written(int year, int month, int day) {
  if (year < 1970 || year > 9999 || month < 1 || month > 12 || day < 1 || day > 31) return {};
  const std::string text = fmt::format("{:04}-{:02}-{:02}", year, month, day);
  const std::int64_t utime = days_since_1970(year, month, day) * 86400 * 1000000;
  return date_text(utime) == text ? text : std::string();
}

}  // namespace

std::string date_problem(std::string_view text) {
  const std::size_t dash = text.find('-');
  const std::size_t second = dash == text.npos ? dash : text.find('-', dash + 1);
  if (second == text.npos) return "is not a date; write it like 2026-04-30";
  const auto year = whole_number(text.substr(0, dash));
  const auto month = whole_number(text.substr(dash + 1, second - dash - 1));
  const auto day = whole_number(text.substr(second + 1));
  const std::string date = year && month && day ? written(*year, *month, *day) : std::string();
  if (date.empty()) return "is not a date that exists; write it like 2026-04-30";
  return text == date ? std::string() : "is not a date as it is sorted; write " + date;
}

}  // namespace orchard
