// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "detection/detection.hpp"
#include "geometry/angles.hpp"

namespace orchard::detection {

/// The fields of trunk_v2_t in the order of the wire, or with `kIsFirstRelease` those of trunk_t;
/// see bus/messages/fields.hpp.
template <bool kIsFirstRelease>
struct TrunkFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("range_m", m.range_m, 0, 1e5);
    v.field("bearing_rad", m.bearing_rad, -4 * geometry::kPi, 4 * geometry::kPi);
    v.field("surface_x_m", m.surface_x_m, -1e6, 1e6);
    v.field("surface_y_m", m.surface_y_m, -1e6, 1e6);
    v.field("centre_x_m", m.centre_x_m, -1e6, 1e6);
    v.field("centre_y_m", m.centre_y_m, -1e6, 1e6);
    v.covariance("covariance", m.covariance);
    v.field("width_m", m.width_m, 0, 1e5);
    v.field("width_sd_m", m.width_sd_m, 0, 1e5);
    v.field("roc_laser", m.roc_laser, 0, 1);
    v.field("roc_colour", m.roc_colour, 0, 1);
    v.field("roc_left_edge", m.roc_left_edge, 0, 1);
    v.field("roc_right_edge", m.roc_right_edge, 0, 1);
    v.field("roc_parallel", m.roc_parallel, 0, 1);
    v.field("roc_edges", m.roc_edges, 0, 1);
    v.field("roc_vision", m.roc_vision, 0, 1);
    v.field("roc_tree", m.roc_tree, 0, 1);
    if constexpr (!kIsFirstRelease) {
      v.field("probability_tree", m.probability_tree, 0, 1);
      v.field("probability_object", m.probability_object, 0, 1);
      v.field("intensity", m.intensity, 0, 1e9);
    }
    v.field("num_beams", m.num_beams, 0, INT32_MAX);
    v.field("label", m.label, 0, 2);
    v.field("occlusion", m.occlusion, 0, 3);
  }
};

/// The fields of detections_v2_t, or with `kIsFirstRelease` those of detections_t in old logs.
template <bool kIsFirstRelease>
struct DetectionsFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_trunks", m.trunks);
    v.time("image_utime", m.image_utime);
    v.items("trunks", m.trunks, "num_trunks", TrunkFields<kIsFirstRelease>{});
  }
};

inline DetectionsFields<false> fields_of(const Detections&) { return {}; }

}  // namespace orchard::detection
