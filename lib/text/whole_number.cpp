// SPDX-License-Identifier: BSD-3-Clause
#include "text/whole_number.hpp"

#include <charconv>

namespace orchard {

std::optional<std::int32_t> whole_number(std::string_view text) {
  std::int32_t value = 0;
  const char* end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

}  // namespace orchard
