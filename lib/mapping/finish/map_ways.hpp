// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mapping/finish/finish.hpp"

namespace orchard::mapping {

struct LongObject {
  std::int32_t id = 0;
  double length_m = 0.0;
  double direction_rad = 0.0;
};

struct Way {
  NavigationEdge edge;          ///< without its line
  std::int32_t num_points = 0;  ///< of the line
};

struct WayPoint {
  double x_m = 0.0, y_m = 0.0;
};

/// A part of what MAP cannot hold of a finished map: extents of long objects, and ways.
struct MapWays {
  std::int64_t utime = 0;
  std::int32_t seq = 0;
  std::int32_t part = 0;
  std::int32_t num_parts = 1;
  std::vector<LongObject> long_objects;
  std::vector<Way> ways;
  std::vector<WayPoint> points;  ///< of the ways, one after the other
};

/// The parts of a finished map, each below 60 kB, at least one; seq is 0. Lines longer than a part
/// lose points.
std::vector<MapWays> map_ways_of(const FinishedMap& map, std::int64_t utime);

/// Puts the parts together again.
class MapWaysCollector {
 public:
  struct Result {
    std::int64_t utime = 0;
    std::vector<LongObject> long_objects;
    NavigationGraph graph;
  };

  /// Returns the whole once its last part is there; parts may arrive in any order, those of another
  /// utime begin anew.
  std::optional<Result> add(const MapWays& part);

 private:
  std::vector<std::optional<MapWays>> parts_;
  std::int64_t utime_ = -1;
};

}  // namespace orchard::mapping
