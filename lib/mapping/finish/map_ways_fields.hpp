// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/finish/map_ways.hpp"
#include "pose/measurement_fields.hpp"

namespace orchard::mapping {

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
    constexpr double kFar_m = pose::kCoordinateMax_m;
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
