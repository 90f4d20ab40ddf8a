// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace orchard {

/// Formats a number with that many decimals, rounded from its exact value, independent of the
/// locale; never "-0.000".
std::string fixed_text(double value, int num_decimals);

/// The shortest decimal text that reads back as the same double.
std::string shortest_text(double value);

/// Parses a whole number without leading or trailing characters. None if the text is not a number
/// or does not fit.
std::optional<std::int32_t> whole_number(std::string_view text);

/// Formats the UTC date of a utime [us since 1970] as "2026-11-22". Empty before 1980 and after
/// 2200, where the clock has another epoch.
std::string date_text(std::int64_t utime);

}  // namespace orchard
