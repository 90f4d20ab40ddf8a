// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard::io {

/// Restricts text to characters of the figures' font: printable ASCII, Latin letters and common
/// signs of UTF-8 are kept; other characters and invalid UTF-8 bytes become '?'.
std::string drawn_text(std::string_view text);

}  // namespace orchard::io
