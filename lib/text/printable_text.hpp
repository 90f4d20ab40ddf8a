// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard {

/// Makes untrusted text safe for a terminal: control characters (single-byte ones, and C1 in UTF-8)
/// become "?", so that it cannot move the cursor or set colours.
std::string printable_text(std::string text);

}  // namespace orchard
