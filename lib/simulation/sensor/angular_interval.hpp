// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace orchard::simulation {

/// A stretch of directions [rad], low <= high, counted from some middle so that nothing wraps.
struct AngularInterval {
  double low_rad = 0.0;
  double high_rad = 0.0;

  double width_rad() const { return high_rad - low_rad; }
};

/// The shared part; of negative width when there is none.
AngularInterval overlap(const AngularInterval& a, const AngularInterval& b);

/// The same directions as few intervals as possible, in rising order.
std::vector<AngularInterval> united(std::vector<AngularInterval> intervals);

/// What is left of `whole` without `parts`, in rising order.
std::vector<AngularInterval> without(const AngularInterval& whole,
                                     std::vector<AngularInterval> parts);

/// Sum of the widths of intervals that do not overlap [rad].
double total_width_rad(const std::vector<AngularInterval>& intervals);

}  // namespace orchard::simulation
