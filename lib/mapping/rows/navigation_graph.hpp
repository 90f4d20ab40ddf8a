// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/free_corridor.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

enum class WayKind { kAlley, kHeadland };

/// Where ways meet: beyond an alley's end, on the headland.
struct NavigationNode {
  std::int32_t id = 0;  ///< from 1
  Eigen::Vector2d p_map{0, 0};
};

/// A way that a vehicle can take, both ways round.
struct NavigationEdge {
  std::int32_t id = 0;  ///< from 1
  WayKind kind = WayKind::kAlley;
  std::int32_t from = 0, to = 0;  ///< nodes; an alley goes with rising positions
  std::int32_t row_left = 0;      ///< numbers of the rows beside an alley; of a headland: the row
  std::int32_t row_right = 0;     ///< that it goes round, and 0
  double length_m = 0.0;
  double width_m = 0.0;  ///< free of everything in the map and seen so, at the narrowest
  std::vector<Eigen::Vector2d> line_map;
};

struct NavigationGraph {
  std::vector<NavigationNode> nodes;
  std::vector<NavigationEdge> edges;  ///< alleys from the left, then headlands
};

/// The ways between rows that stand beside each other, and round their ends.
///
/// Each is the line that keeps farthest from every landmark's border and was seen free on both
/// sides; where there is none at least 2 kHalfWayMin_m wide, no way is published. Rows farther
/// apart than 2.5 times the usual distance have no alley between them; outside of the outermost
/// rows nothing is known to be free. Alleys reach up to half an alley beyond the ends of the rows.
NavigationGraph navigation_graph(const std::vector<Landmark>& landmarks,
                                 const std::vector<Row>& rows, const SeenFree& seen_free = {});

/// Distances between neighbouring trees of a row, places without one not counted [m].
struct RowSpacing {
  double median_m = 0.0, least_m = 0.0, most_m = 0.0, sd_m = 0.0;
};
RowSpacing row_spacing(const Row& row);

}  // namespace orchard::mapping
