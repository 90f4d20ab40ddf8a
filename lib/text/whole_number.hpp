// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orchard {

/// Parses a whole number without leading or trailing characters. None if the text is not a number
/// or does not fit.
std::optional<std::int32_t> whole_number(std::string_view text);

}  // namespace orchard
