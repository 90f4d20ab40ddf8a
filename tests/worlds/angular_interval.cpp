// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/angular_interval.hpp"

#include <algorithm>
#include <utility>

namespace orchard::simulation {

AngularInterval overlap(const AngularInterval& a, const AngularInterval& b) {
  return {std::max(a.low_rad, b.low_rad), std::min(a.high_rad, b.high_rad)};
}

std::vector<AngularInterval> united(std::vector<AngularInterval> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const AngularInterval& a, const AngularInterval& b) {
              return std::make_pair(a.low_rad, a.high_rad) < std::make_pair(b.low_rad, b.high_rad);
            });
  std::vector<AngularInterval> result;
  for (const AngularInterval& next : intervals) {
    if (next.width_rad() <= 0.0) continue;
    if (!result.empty() && next.low_rad <= result.back().high_rad) {
      result.back().high_rad = std::max(result.back().high_rad, next.high_rad);
    } else {
      result.push_back(next);
    }
  }
  return result;
}

std::vector<AngularInterval> without(const AngularInterval& whole,
                                     std::vector<AngularInterval> parts) {
  std::vector<AngularInterval> result;
  double low_rad = whole.low_rad;
  for (const AngularInterval& part : united(std::move(parts))) {
    if (part.high_rad <= low_rad || part.low_rad >= whole.high_rad) continue;
    if (part.low_rad > low_rad) result.push_back({low_rad, part.low_rad});
    low_rad = part.high_rad;
  }
  if (low_rad < whole.high_rad) result.push_back({low_rad, whole.high_rad});
  return result;
}

double total_width_rad(const std::vector<AngularInterval>& intervals) {
  double sum_rad = 0.0;
  for (const AngularInterval& interval : intervals) sum_rad += interval.width_rad();
  return sum_rad;
}

}  // namespace orchard::simulation
