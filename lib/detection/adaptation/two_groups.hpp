// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::detection {

/// The cut of some numbers into two groups that lie farthest apart for their own spread.
struct TwoGroups {
  double threshold = 0.0;     ///< halfway between the groups' nearest members
  double low_mean = 0.0;      ///< of the numbers below it
  double high_mean = 0.0;     ///< of the rest
  double low_fraction = 0.0;  ///< of all numbers
  double separation = 0.0;    ///< of the means, in the groups' pooled standard deviation
};

/// Cuts numbers into the two groups with the largest separation D = (m2 - m1) / sqrt((s1^2 +
/// s2^2) / 2) (Ashman, Bird and Zepf 1994), each with at least `min_fraction` of them and two; the
/// deviations are never taken smaller than `sd_floor`. None with fewer than four numbers.
///
/// One normal population cut in its middle has D = 2.6, an even one 3.5; D above 4 says two.
std::optional<TwoGroups> find_two_groups(std::vector<double> values, double min_fraction,
                                         double sd_floor);

}  // namespace orchard::detection
