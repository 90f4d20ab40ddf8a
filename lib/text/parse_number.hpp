// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>

namespace orchard {

/// Parses a number without leading or trailing characters, a whole one to any base. None if the
/// text is not a number or does not fit.
template <class Number>
std::optional<Number> parse_number(std::string_view text, int base = 10) {
  Number value{};
  std::from_chars_result result{};
  const char *begin = text.data(), *end = text.data() + text.size();
  if constexpr (std::is_integral_v<Number>) {
    result = std::from_chars(begin, end, value, base);
  } else {
    result = std::from_chars(begin, end, value);
  }
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

}  // namespace orchard
