// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "geometry/point_grid.hpp"
#include "mapping/landmark.hpp"
#include "mapping/rows/polyline.hpp"

namespace orchard::mapping {

/// Minimum half width of a corridor [m]; vehicles need more.
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

}  // namespace orchard::mapping
