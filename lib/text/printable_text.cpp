// SPDX-License-Identifier: BSD-3-Clause
#include "text/printable_text.hpp"

namespace orchard {

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
