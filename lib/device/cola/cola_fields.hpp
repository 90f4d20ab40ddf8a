// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orchard::device {

/// The fields of a CoLa-A telegram, one after the other: they are separated by single blanks.
/// After the first field that is missing or no number of its kind, nothing more is read.
class ColaFields {
 public:
  explicit ColaFields(std::string_view telegram) : rest_(telegram) {}

  bool ok() const { return ok_; }

  /// The next field as text; empty after the last.
  std::string_view text();

  /// A number without sign in up to eight hexadecimal digits, not above `max`.
  std::uint32_t number(std::uint32_t max = 0xffffffffu);

  /// A number of 32 bits with sign: in hexadecimal two's complement, or decimal after + or -.
  std::int32_t signed_number();

  /// An IEEE 754 number in hexadecimal digits ("3F800000" is 1).
  float real();

  void skip(int num_fields);

 private:
  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace orchard::device
