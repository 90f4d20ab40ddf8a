// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::simulation {

/// An interval of directions [rad], low <= high, relative to a middle chosen so that nothing wraps.
struct AngularInterval {
  double low_rad = 0.0;
  double high_rad = 0.0;

  double width_rad() const { return high_rad - low_rad; }
};

/// The intersection; its width is negative when there is none.
AngularInterval overlap(const AngularInterval& a, const AngularInterval& b);

/// The union as disjoint intervals in ascending order.
std::vector<AngularInterval> united(std::vector<AngularInterval> intervals);

/// The difference of `whole` and `parts`, in ascending order.
std::vector<AngularInterval> without(const AngularInterval& whole,
                                     std::vector<AngularInterval> parts);

/// Sum of the widths of intervals that do not overlap [rad].
double total_width_rad(const std::vector<AngularInterval>& intervals);

}  // namespace orchard::simulation
