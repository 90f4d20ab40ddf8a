// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/walked_line.hpp"

namespace orchard::mapping {

/// Nothing narrower than twice this is a way [m]: no vehicle passes.
inline constexpr double kHalfWayMin_m = 0.35;

/// Whether something has seen a place of map free: beams that passed, or the robot itself. Empty:
/// nobody can tell, and only the landmarks count.
using SeenFree = std::function<bool(const Eigen::Vector2d& p_map)>;

/// Everything in the map with its extent, whatever its class.
class Obstacles {
 public:
  explicit Obstacles(const std::vector<Landmark>& landmarks);

  /// From a point to the nearest border [m], `reach_m` at most; below 0 inside of one.
  double clearance_m(const Eigen::Vector2d& p_map, double reach_m) const;

  /// The same of a line: of its nearest point.
  double clearance_m(const Line& line, double reach_m) const;

 private:
  IndexedPoints places_;
  std::vector<double> radius_m_;
  double largest_m_ = 0.0;
};

/// A line with free ground on both sides of it.
struct Corridor {
  Line line;
  double width_m = 0.0;  ///< twice the distance to what is nearest to the line
};

/// What a corridor runs along.
struct Guide {
  std::vector<LinePoint> stations;  ///< at even steps
  double half_m = 0.0;              ///< how far beside them it may run, and be wide to each side
  std::size_t num_extra = 0;        ///< of the stations at both ends, which it may do without
  bool pinned = false;              ///< it begins and ends on the stations
};

/// Of all lines along the guide the one that keeps farthest from everything at its narrowest place,
/// of equal ones that nearest to the guide. None where that is less than kHalfWayMin_m, or not
/// seen free to both sides.
std::optional<Corridor> free_corridor(const Guide& guide, const Obstacles& obstacles,
                                      const SeenFree& seen_free);

}  // namespace orchard::mapping
