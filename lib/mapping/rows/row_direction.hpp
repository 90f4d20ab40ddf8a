// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orchard::mapping {

/// Tree spacing and row directions of an orchard.
struct RowDirections {
  double spacing_m = 0.0;                   ///< median distance to the nearest tree
  std::vector<Eigen::Vector2d> directions;  ///< unit vector per tree, consistently oriented
};

/// Estimates the direction of the row through each tree from the lines on which its neighbours
/// stand; neighbouring trees are made to agree, so that the direction follows a curved row.
///
/// Points in map [m]; fewer than three give empty directions.
RowDirections row_directions(const std::vector<Eigen::Vector2d>& p_map);

}  // namespace orchard::mapping
