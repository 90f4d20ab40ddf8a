// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace orchard::bench {

/// The value that a share of all values does not exceed; the greatest for the few above it.
inline double quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size())) - 1.0;
  return values.at(static_cast<std::size_t>(std::max(rank, 0.0)));
}

inline double median(const std::vector<double>& values) { return quantile(values, 0.5); }

}  // namespace orchard::bench
