// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orchard::device {

/// Reads the fields of a CoLa-A telegram in sequence; single blanks separate them. After the first
/// missing or malformed field, ok() is false and nothing more is read.
class ColaFields {
 public:
  explicit ColaFields(std::string_view telegram) : rest_(telegram) {}

  bool ok() const { return ok_; }

  /// The next field as text; empty after the last.
  std::string_view text();

  /// Reads an unsigned number of up to eight hexadecimal digits, not above `max`.
  std::uint32_t number(std::uint32_t max = 0xffffffffu);

  /// Reads a signed 32-bit number: hexadecimal two's complement, or decimal after + or -.
  std::int32_t signed_number();

  /// Reads an IEEE 754 number in hexadecimal digits ("3F800000" is 1).
  float real();

  void skip(int num_fields);

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace orchard::device
