// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace orchard {

/// The day of a time since 1970 in UTC, as "2026-11-22"; empty before 1980 and after 2200, where a
/// clock counted from something else.
std::string date_text(std::int64_t utime);

}  // namespace orchard
