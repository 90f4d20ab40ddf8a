// SPDX-License-Identifier: BSD-3-Clause
#include "text/encoded_text.hpp"

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

std::string markup_text(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::string printable_text(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool control = byte < 0x20 || byte == 0x7F;
    const bool c1 = byte == 0xC2 && i + 1 < text.size() &&
                    static_cast<unsigned char>(text[i + 1]) >= 0x80 &&
                    static_cast<unsigned char>(text[i + 1]) < 0xA0;
    // a C1 character as a single byte, as read by terminals without UTF-8
    const bool c1_alone =
        byte >= 0x80 && byte < 0xA0 && (i == 0 || static_cast<unsigned char>(text[i - 1]) < 0x80);
    if (control || c1 || c1_alone) text[i] = '?';
    if (c1) text[i + 1] = '?';
  }
  return text;
}

}  // namespace orchard
