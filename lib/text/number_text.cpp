// SPDX-License-Identifier: BSD-3-Clause
#include "text/number_text.hpp"

#include <charconv>

namespace orchard {

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

}  // namespace orchard
