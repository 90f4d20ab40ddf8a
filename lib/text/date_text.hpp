// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace orchard {

/// Formats the UTC date of a utime [us since 1970] as "2026-11-22". Empty before 1980 and after
/// 2200, where the clock has another epoch.
std::string date_text(std::int64_t utime);

}  // namespace orchard
