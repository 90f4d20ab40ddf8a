// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

namespace orchard::io {

/// Rounds to a multiple of 1/scale (default 0.1 mm for metres), so that files contain no
/// meaningless digits.
inline double rounded(double value, double scale = 1e4) {
  return std::round(value * scale) / scale;
}

inline double millimetres(double value_m) { return rounded(value_m, 1e3); }

/// Formats a row or position number; empty for 0 (none).
inline std::string number_or_empty(std::int32_t number) {
  return number == 0 ? std::string() : std::to_string(number);
}

}  // namespace orchard::io
