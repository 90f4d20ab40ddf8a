// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/landmark.hpp"
#include "pose/measurement_fields.hpp"

namespace orchard::mapping {

/// The fields of landmark_t in wire order; see bus/messages/fields.hpp.
struct LandmarkFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    constexpr double kFar_m = pose::kCoordinateMax_m;
    v.field("id", m.id, 0, INT32_MAX);
    v.field("label", m.label, 0, 2);
    v.field("num_observations", m.num_observations, 0, INT32_MAX);
    v.field("x_m", m.x_m, -kFar_m, kFar_m);
    v.field("y_m", m.y_m, -kFar_m, kFar_m);
    v.field("se_x_m", m.se_x_m, 0, kFar_m);
    v.field("se_y_m", m.se_y_m, 0, kFar_m);
    v.covariance("covariance", m.covariance);
    v.field("width_m", m.width_m, 0, 1e5);
    v.field("roc_mean", m.roc_mean, 0, 1);
    v.field("probability", m.probability, 0, 1);
    v.field("row", m.row, 0, INT32_MAX);
    v.field("position", m.position, 0, INT32_MAX);
  }
};

/// The fields of map_tile_t.
struct MapTileFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.stamp(m.utime, m.seq);
    v.count("num_landmarks", m.landmarks);
    v.count("num_removed", m.removed_ids);
    v.field("num_landmarks_total", m.num_landmarks_total, 0, INT32_MAX);
    v.items("landmarks", m.landmarks, "num_landmarks", LandmarkFields{});
    v.array("removed_ids", m.removed_ids, "num_removed", 0, INT32_MAX);
  }
};

inline MapTileFields fields_of(const MapTile&) { return {}; }

}  // namespace orchard::mapping
