// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

namespace orchard::timing {

/// Converts microseconds of message time to seconds.
inline double seconds(std::int64_t duration_us) { return 1e-6 * static_cast<double>(duration_us); }

/// Converts seconds to microseconds, rounded to the nearest.
inline std::int64_t microseconds(double duration_s) { return std::llround(duration_s * 1e6); }

}  // namespace orchard::timing
