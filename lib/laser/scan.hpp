// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace orchard::laser {

/// One sweep of a 2D laser scanner in the laser frame (x forward, y left).
struct Scan {
  std::int64_t utime = 0;          ///< time of the first beam [us]
  std::int32_t seq = 0;            ///< +1 per scan of its source
  double bearing_min_rad = 0.0;    ///< bearing of ranges_m[0], counter-clockwise positive
  double bearing_step_rad = 0.0;   ///< between neighbouring beams; never 0
  double beam_period_us = 0.0;     ///< time between neighbouring beams [us]; 0 = unknown
  double range_min_m = 0.0;        ///< nearest valid return
  double range_max_m = 0.0;        ///< farthest valid return
  std::vector<float> ranges_m;     ///< one per beam; 0 = no return
  std::vector<float> intensities;  ///< empty, or one per beam

  /// Bearing of a beam in the laser frame [rad]; `beam` may lie between two beams.
  double bearing_rad(double beam) const { return bearing_min_rad + beam * bearing_step_rad; }

  bool has_intensities() const {
    return !intensities.empty() && intensities.size() == ranges_m.size();
  }

  /// Whether beam `i` has a return within the valid ranges.
  bool valid(std::size_t i) const {
    const double range_m = ranges_m[i];
    return range_m >= range_min_m && range_m <= range_max_m && range_m > 0.0;
  }
};

/// A sweep of the second scanner, channel SCAN.rear. A separate type, so that the two scanners
/// cannot be confused.
struct RearScan : Scan {};

}  // namespace orchard::laser
