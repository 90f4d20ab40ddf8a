// SPDX-License-Identifier: BSD-3-Clause
#include "io/figure/drawn_text.hpp"

#include <cstddef>

namespace orchard::io {
namespace {

unsigned byte_at(std::string_view text, std::size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
}

bool continues(unsigned byte) { return (byte & 0xC0u) == 0x80u; }

/// Number of bytes of the UTF-8 character that begins here; 0 if none does.
std::size_t length_at(std::string_view text, std::size_t i) {
  const unsigned first = byte_at(text, i), second = byte_at(text, i + 1),
                 third = byte_at(text, i + 2);
  if (first < 0x80u) return 1;
  if (first >= 0xC2u && first < 0xE0u && continues(second)) return 2;
  const bool is_shortest = first != 0xE0u || second >= 0xA0u;
  if (first >= 0xE0u && first < 0xF0u && is_shortest && continues(second) && continues(third)) {
    return 3;
  }
  return first >= 0xF0u && first < 0xF5u && continues(second) && continues(third) &&
                 continues(byte_at(text, i + 3))
             ? 4
             : 0;
}

/// Whether DejaVu Sans has the character: Latin letters, dashes, quotes and arithmetic signs.
bool is_drawn(std::string_view character) {
  const unsigned first = byte_at(character, 0), second = byte_at(character, 1),
                 third = byte_at(character, 2);
  if (character.size() == 1) return first >= ' ' && first <= '~';
  if (character.size() == 2) {
    const unsigned code = (first & 0x1Fu) << 6 | (second & 0x3Fu);
    return code >= 0xA1u && code < 0x250u && code != 0xADu;  // the soft hyphen is not drawn
  }
  if (character.size() != 3) return false;
  const unsigned code = (first & 0x0Fu) << 12 | (second & 0x3Fu) << 6 | (third & 0x3Fu);
  return (code >= 0x2010u && code < 0x2028u) || (code >= 0x2190u && code < 0x2300u);
}

}  // namespace

std::string drawn_text(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = length_at(text, i);
    const std::string_view character = text.substr(i, length);
    if (length > 0 && is_drawn(character)) {
      result += character;
    } else {
      result += '?';
    }
    i += length > 0 ? length : 1;
  }
  return result;
}

}  // namespace orchard::io
