// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

namespace orchard::calibration {

/// Split of values into two groups with the largest separation.
struct TwoGroups {
  double threshold = 0.0;     ///< halfway between the nearest members of the groups
  double low_mean = 0.0;      ///< mean of the values below the threshold
  double high_mean = 0.0;     ///< mean of the values above
  double low_fraction = 0.0;  ///< fraction of the values in the lower group
  double separation = 0.0;    ///< of the means, in pooled standard deviations
};

/// Splits values into the two groups with the largest separation D = (m2 - m1) / sqrt((s1^2 + s2^2)
/// / 2) (Ashman, Bird and Zepf 1994). Each group has at least `min_fraction` of the values and at
/// least two; `sd_floor` is the lower limit of the pooled deviation. None with fewer than four
/// values.
///
/// A single population split in the middle has D = 2.6 if normal and 3.5 if uniform; D above 4
/// indicates two populations.
std::optional<TwoGroups> find_two_groups(std::vector<double> values, double min_fraction,
                                         double sd_floor);

}  // namespace orchard::calibration
