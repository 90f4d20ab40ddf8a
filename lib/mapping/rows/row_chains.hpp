// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Weight of each tree in finding rows: its confidence (probability times roc_mean) divided by half
/// the map's median. 1 or more is full strength; posts and parts of bushes mistaken for trees have
/// less.
std::vector<double> row_strengths(const std::vector<const Landmark*>& trees);

/// Indices of the trees of full strength, in order, from which rows are guessed first. Of several
/// trees within a third of the spacing (a bush, two stems) only the strongest is one.
std::vector<std::size_t> seed_trees(const std::vector<Eigen::Vector2d>& p_map,
                                    const std::vector<double>& strengths);

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

/// Indices of the trees of one row, in order along its direction.
using RowChain = std::vector<std::int32_t>;

/// Index of a chain's element in the list of all trees.
inline std::size_t index_of(std::int32_t tree) { return static_cast<std::size_t>(tree); }

/// Distance from a point to the line segment from a to b [m]; points in one frame.
double distance_to_segment_m(const Eigen::Vector2d& p, const Eigen::Vector2d& a,
                             const Eigen::Vector2d& b);

/// Links trees that follow each other in a row. Short links are made first, so that a gap of
/// missing trees is bridged only where no nearer tree fits. Gaps up to `gap_max_spacings`.
std::vector<RowChain> row_chains(const std::vector<Eigen::Vector2d>& p_map,
                                 const RowDirections& rows, double gap_max_spacings);

}  // namespace orchard::mapping
