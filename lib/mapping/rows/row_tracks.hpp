// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/rows/row_field.hpp"

namespace orchard::mapping {

/// Minimum number of trees of a row: two are always in line.
inline constexpr std::size_t kRowTreesMin = 3;

/// A chain of trees with the evidence that it was planted.
struct RowTrack {
  RowChain chain;
  double log_odds = 0.0;          ///< that it was planted, against objects at any position
  double log_odds_in_line = 0.0;  ///< the same, against objects at any distances on a line: a hedge
};

/// Finds the rows that explain the trees best: chains of maximum log odds against objects that
/// stand at any position, the most probable one first; no tree is in two. Of two trees and more.
///
/// A step adds the logarithm of the density of the next tree, as the map's rows are regular, over
/// the density of the objects around it, and of how frequent the tree's strength is in rows and
/// outside. A row begins where as many as one in a map would by chance; gaps, clutter and ends
/// follow from that.
///
/// `p_map`: trees in the map frame [m]; `strengths`, `local`: one for each, see row_strengths and
/// local_rows. `known`: the rows found so far, from which regularity, clutter and strengths are
/// learnt.
std::vector<RowTrack> row_tracks(const std::vector<Eigen::Vector2d>& p_map,
                                 const std::vector<double>& strengths,
                                 const std::vector<LocalRows>& local,
                                 const std::vector<RowChain>& known);

}  // namespace orchard::mapping
