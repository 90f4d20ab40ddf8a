// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// How trees stand about each other.
struct RowDirections {
  double spacing_m = 0.0;                   ///< median distance to the nearest tree
  std::vector<Eigen::Vector2d> directions;  ///< unit vector per tree along its row, all alike
};

/// The direction of the row through each tree, from the lines in which its neighbours stand,
/// made consistent over the orchard so that a curved row's direction turns with it.
///
/// Points in the map frame [m]; needs at least three, else directions are empty.
RowDirections row_directions(const std::vector<Eigen::Vector2d>& p_map);

}  // namespace orchard::mapping
