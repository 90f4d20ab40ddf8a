// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace orchard {

/// Encodes bytes in base 64 with padding (RFC 4648, section 4).
std::string base64_text(const std::uint8_t* data, std::size_t size);

/// Escapes & < > " for XML and HTML, in element content or between double quotes.
std::string markup_text(std::string_view text);

/// Makes untrusted text safe for a terminal: control characters (single-byte ones, and C1 in UTF-8)
/// become "?", so that it cannot move the cursor or set colours.
std::string printable_text(std::string text);

}  // namespace orchard
