// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::pose {

/// Configuration of the motion estimate by scan matching. Section `pose.scan_motion`.
struct ScanMotionConfig {
  double range_min_m = 0.3;
  double range_max_m = 30.0;
  bool deskew = true;

  double search_shift_m = 0.6;
};

template <class Visitor>
void describe(Visitor& v, ScanMotionConfig& c) {
  v.number("range_min_m", c.range_min_m, 0, 100, "m",
           "nearer returns are ignored (the robot itself)");
  v.number("range_max_m", c.range_max_m, 0.5, 500, "m", "farther returns are ignored");
  v.flag("deskew", c.deskew, "compensate the motion within a scan, if SCAN states its beam period");
  v.number("search_shift_m", c.search_shift_m, 0, 5, "m",
           "search range of the position, to each side of the predicted one");
  v.check(c.range_min_m < c.range_max_m, "range_min_m", "must be below range_max_m");
}

}  // namespace orchard::pose
