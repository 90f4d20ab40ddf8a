// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

namespace orchard::io {

/// Rounded to a whole number of 1/scale (0.1 mm of metres): files hold no digits nobody measured.
inline double rounded(double value, double scale = 1e4) {
  return std::round(value * scale) / scale;
}

inline double millimetres(double value_m) { return rounded(value_m, 1e3); }

/// A row or its position; nothing where there is none (0).
inline std::string number_or_empty(std::int32_t number) {
  return number == 0 ? std::string() : std::to_string(number);
}

}  // namespace orchard::io
