// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/point_grid.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// A polyline in map [m].
using Line = std::vector<Eigen::Vector2d>;

/// A point of a line with the line's direction there (unit vector).
struct LinePoint {
  Eigen::Vector2d p{0, 0};
  Eigen::Vector2d along{1, 0};
};

/// Unit vector to the right of a direction.
inline Eigen::Vector2d right_of(const Eigen::Vector2d& along) { return {along.y(), -along.x()}; }

double length_m(const Line& line);

/// Points along a line, evenly spaced by at most `step_m`, including both ends; empty for a line of
/// zero length.
std::vector<LinePoint> sample_line(const Line& line, double step_m);

/// derived: Minimum half width of a corridor [m]; vehicles need more.
inline constexpr double kHalfCorridorMin_m = 0.35;

/// Whether a position in map was observed free or driven over. If empty, only the landmarks limit a
/// corridor.
using FreeSpaceTest = std::function<bool(const Eigen::Vector2d& p_map)>;

/// All landmarks with their extent, regardless of class.
class Obstacles {
 public:
  explicit Obstacles(const std::vector<Landmark>& landmarks);

  /// Distance from a point to the nearest border [m], at most `reach_m`; negative inside a
  /// landmark.
  double clearance_m(const Eigen::Vector2d& p_map, double reach_m) const;

  /// The same for the point of a line that is nearest to a border.
  double clearance_m(const Line& line, double reach_m) const;

 private:
  geometry::IndexedPoints places_;
  std::vector<double> radius_m_;
  double largest_m_ = 0.0;
};

/// A line with free ground on both sides.
struct Corridor {
  Line line;
  double width_m = 0.0;  ///< twice the minimum clearance of the line
};

/// Reference line of a corridor.
struct Guide {
  std::vector<LinePoint> stations;  ///< evenly spaced
  double half_m = 0.0;              ///< max lateral offset of the line, and max half width
  std::size_t num_extra = 0;        ///< optional stations at each end, used as far as they are free
  bool pinned = false;              ///< the line starts and ends exactly on the guide
};

/// Finds the line along the guide with the largest minimum clearance; among equal ones, the one
/// nearest to the guide. None if that clearance is below kHalfCorridorMin_m or the ground beside
/// the line was not observed free.
std::optional<Corridor> free_corridor(const Guide& guide, const Obstacles& obstacles,
                                      const FreeSpaceTest& seen_free);

enum class EdgeKind : std::int8_t { kAisle, kHeadland };

/// A node of the navigation graph: the end of an aisle, on the headland.
struct NavigationNode {
  std::int32_t id = 0;  ///< from 1
  Eigen::Vector2d p_map{0, 0};
};

/// An edge that a vehicle can follow in both directions.
struct NavigationEdge {
  std::int32_t id = 0;  ///< from 1
  EdgeKind kind = EdgeKind::kAisle;
  std::int32_t from = 0, to = 0;  ///< node ids; an aisle runs in the direction of rising positions
  std::int32_t row_left = 0;      ///< row left of the aisle; of a headland, the row it goes around
  std::int32_t row_right = 0;     ///< row right of the aisle; 0 for a headland
  double length_m = 0.0;
  double width_m = 0.0;  ///< free width at the narrowest point
  std::vector<Eigen::Vector2d> line_map;
};

struct NavigationGraph {
  std::vector<NavigationNode> nodes;
  std::vector<NavigationEdge> edges;  ///< aisles from the left, then headlands
};

/// Builds the navigation graph: aisles between neighbouring rows and headland paths around the
/// rows' ends.
///
/// Each edge is the line with the largest clearance from all landmarks on ground that was observed
/// free; edges narrower than 2 kHalfCorridorMin_m are omitted. There are no aisles between rows
/// farther apart than 2.5 times the median distance, nor outside the outermost rows, where free
/// ground is unknown. Aisles extend beyond the rows' ends by up to half their width. Without
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
