// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/angles.hpp"
#include "laser/scan.hpp"

namespace orchard::laser {

/// The fields of scan_t in the order of the wire; see bus/messages/fields.hpp.
struct ScanFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_ranges", m.ranges_m);
    v.count("num_intensities", m.intensities);
    v.field("bearing_min_rad", m.bearing_min_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("bearing_step_rad", m.bearing_step_rad, -geometry::kPi, geometry::kPi);
    v.field("beam_period_us", m.beam_period_us, 0, 1e7);
    v.field("range_min_m", m.range_min_m, 0, 1e5);
    v.field("range_max_m", m.range_max_m, 0, 1e5);
    v.array("ranges_m", m.ranges_m, "num_ranges");
    v.array("intensities", m.intensities, "num_intensities");
  }
};

inline ScanFields fields_of(const Scan&) { return {}; }

}  // namespace orchard::laser
