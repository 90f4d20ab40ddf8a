// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace orchard::io {

/// Text from anywhere as the figures' font can draw it: printable ASCII, Latin letters and common
/// signs of UTF-8 stay; every other character, and every byte that is no UTF-8, becomes '?'.
std::string drawn_text(std::string_view text);

}  // namespace orchard::io
