// SPDX-License-Identifier: BSD-3-Clause
#include "text/base64.hpp"

namespace orchard {

std::string base64_text(const std::uint8_t* data, std::size_t size) {
  constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const std::size_t num = size - i < 3 ? size - i : 3;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < num ? data[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= num ? kLetters[bits >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return text;
}

}  // namespace orchard
