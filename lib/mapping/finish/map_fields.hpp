// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/finish/map_ways.hpp"
#include "mapping/landmark.hpp"
#include "pose/pose_fields.hpp"

namespace orchard::mapping {

/// The fields of landmark_t in wire order; see bus/messages/fields.hpp.
struct LandmarkFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    constexpr double kFar_m = pose::kCoordinateMax_m;  // derived: of any coordinate
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

/// The fields of long_object_t in wire order; see bus/messages/fields.hpp.
struct LongObjectFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.field("id", m.id, 0, INT32_MAX);
    v.field("length_m", m.length_m, 0, pose::kCoordinateMax_m);
    v.field("direction_rad", m.direction_rad, -7, 7);
  }
};

/// The fields of way_t.
struct WayFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.field("id", m.edge.id, 0, INT32_MAX);
    v.field("kind", m.edge.kind, 0, 1);
    v.field("from_node", m.edge.from, 0, INT32_MAX);
    v.field("to_node", m.edge.to, 0, INT32_MAX);
    v.field("row_left", m.edge.row_left, 0, INT32_MAX);
    v.field("row_right", m.edge.row_right, 0, INT32_MAX);
    v.field("length_m", m.edge.length_m, 0, pose::kCoordinateMax_m);
    v.field("width_m", m.edge.width_m, 0, pose::kCoordinateMax_m);
    v.field("num_points", m.num_points, 0, INT32_MAX);
  }
};

/// The fields of map_ways_t.
struct MapWaysFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    constexpr double kFar_m = pose::kCoordinateMax_m;  // derived: of any coordinate
    v.stamp(m.utime, m.seq);
    v.count("num_long_objects", m.long_objects);
    v.count("num_ways", m.ways);
    v.count("num_points", m.points);
    v.field("part", m.part, 0, INT32_MAX);
    v.field("num_parts", m.num_parts, 1, 100'000);
    v.items("long_objects", m.long_objects, "num_long_objects", LongObjectFields{});
    v.items("ways", m.ways, "num_ways", WayFields{});
    v.column("x_m", m.points, "num_points", &WayPoint::x_m, -kFar_m, kFar_m);
    v.column("y_m", m.points, "num_points", &WayPoint::y_m, -kFar_m, kFar_m);
  }
};

inline MapWaysFields fields_of(const MapWays&) { return {}; }

}  // namespace orchard::mapping
