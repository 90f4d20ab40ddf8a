// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace orchard {

/// The whole number that a text is, with nothing before or behind it; none when it is no such
/// number or does not fit.
std::optional<std::int32_t> whole_number(std::string_view text);

}  // namespace orchard
