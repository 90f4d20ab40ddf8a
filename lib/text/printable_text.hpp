// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace orchard {

/// Text from outside for a terminal: control characters (those of one byte, and the C1 ones of
/// UTF-8) are replaced by "?", so that no name can move the cursor or set colours.
std::string printable_text(std::string text);

}  // namespace orchard
