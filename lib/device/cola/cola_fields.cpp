// SPDX-License-Identifier: BSD-3-Clause
#include "device/cola/cola_fields.hpp"

#include <charconv>
#include <cstring>

namespace orchard::device {

std::string_view ColaFields::text() {
  if (!ok_ || rest_.empty()) {
    ok_ = false;
    return {};
  }
  const std::size_t end = rest_.find(' ');
  const std::string_view field = rest_.substr(0, end);
  rest_ = end == std::string_view::npos ? std::string_view() : rest_.substr(end + 1);
  if (field.empty()) ok_ = false;
  return field;
}

std::uint32_t ColaFields::number(std::uint32_t max) {
  const std::string_view field = text();
  std::uint32_t number = 0;
  const auto end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, number, 16);
  if (!ok_ || field.size() > 8 || result.ec != std::errc() || result.ptr != end || number > max) {
    ok_ = false;
    return 0;
  }
  return number;
}

std::int32_t ColaFields::signed_number() {
  const std::string_view next = rest_.substr(0, 1);
  if (next != "+" && next != "-") {
    const std::uint32_t bits = number();
    std::int32_t value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  std::string_view field = text();
  if (!field.empty() && field.front() == '+') field.remove_prefix(1);
  std::int32_t value = 0;
  const auto end = field.data() + field.size();
  const auto result = std::from_chars(field.data(), end, value);
  if (!ok_ || field.empty() || result.ec != std::errc() || result.ptr != end) {
    ok_ = false;
    return 0;
  }
  return value;
}

float ColaFields::real() {
  const std::uint32_t bits = number();
  float value = 0.0f;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

void ColaFields::skip(int num_fields) {
  for (int i = 0; i < num_fields; ++i) text();
}

}  // namespace orchard::device
