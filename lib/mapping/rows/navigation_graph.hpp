// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/free_corridor.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

enum class EdgeKind : std::int8_t { kAlley, kHeadland };

/// A node of the navigation graph: the end of an alley, on the headland.
struct NavigationNode {
  std::int32_t id = 0;  ///< from 1
  Eigen::Vector2d p_map{0, 0};
};

/// An edge that a vehicle can follow in both directions.
struct NavigationEdge {
  std::int32_t id = 0;  ///< from 1
  EdgeKind kind = EdgeKind::kAlley;
  std::int32_t from = 0, to = 0;  ///< node ids; an alley runs in the direction of rising positions
  std::int32_t row_left = 0;      ///< row left of the alley; of a headland, the row it goes around
  std::int32_t row_right = 0;     ///< row right of the alley; 0 for a headland
  double length_m = 0.0;
  double width_m = 0.0;  ///< free width at the narrowest point
  std::vector<Eigen::Vector2d> line_map;
};

struct NavigationGraph {
  std::vector<NavigationNode> nodes;
  std::vector<NavigationEdge> edges;  ///< alleys from the left, then headlands
};

/// Builds the navigation graph: alleys between neighbouring rows and headland paths around the
/// rows' ends.
///
/// Each edge is the line with the largest clearance from all landmarks on ground that was observed
/// free; edges narrower than 2 kHalfCorridorMin_m are omitted. There are no alleys between rows
/// farther apart than 2.5 times the median distance, nor outside the outermost rows, where free
/// ground is unknown. Alleys extend beyond the rows' ends by up to half their width. Without
/// `seen_free` only the landmarks count.
NavigationGraph navigation_graph(const std::vector<Landmark>& landmarks,
                                 const std::vector<Row>& rows, const FreeSpaceTest& seen_free = {});

/// The graph with obstacles that were not known when it was made: edges become as narrow as they
/// leave, and those narrower than 2 kHalfCorridorMin_m are omitted, with nodes that no edge reaches
/// any more. Lines and ids stay.
NavigationGraph narrowed(NavigationGraph graph, const std::vector<Landmark>& obstacles);

/// Statistics of the distances between neighbouring trees of a row [m]; pairs with an empty slot
/// between them are not counted.
struct RowSpacing {
  double median_m = 0.0, least_m = 0.0, most_m = 0.0, sd_m = 0.0;
};
RowSpacing row_spacing(const Row& row);

}  // namespace orchard::mapping
