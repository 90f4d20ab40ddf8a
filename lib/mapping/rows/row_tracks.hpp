// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Direction of the rows and spacing of their trees at a point of the map.
struct LocalRows {
  Eigen::Vector2d direction{1.0, 0.0};  ///< unit vector, map frame
  double spacing_m = 0.0;
};

/// Directions and spacings of the rows over the map, learnt from the links between successive
/// trees: one element for each of `p_map`, trees in the map frame [m].
///
/// `seeds_spacing_m`: used if there are no links. `chains`: indices into p_map. The direction at a
/// point is a robust linear function of position, fitted to the links around it: clutter at the end
/// of a row is outvoted by the links of all rows there, and curved rows are extrapolated along
/// their curve.
std::vector<LocalRows> local_rows(const std::vector<Eigen::Vector2d>& p_map, double seeds_spacing_m,
                                  const std::vector<RowChain>& chains);

/// How regular the rows of a map are, learnt from their links; the defaults are a first guess.
struct RowRegularity {
  double along_spacings = 0.2;   ///< mean deviation of a step from the spacing, in spacings
  double beside_spacings = 0.1;  ///< mean lateral offset of the next tree, in spacings
  double filled = 0.9;           ///< share of the slots after a tree that have a tree
};

/// Returns the regularity over all links of `chains`: medians, as of exponential distributions:
/// most trees are on the line, some are far off where poses were poor.
RowRegularity row_regularity(const std::vector<Eigen::Vector2d>& p_map,
                             const std::vector<LocalRows>& local,
                             const std::vector<RowChain>& chains);

/// A step from one tree to a later one, in slots.
struct RowStep {
  int num_slots = 0;      ///< 1: the next one; 0 or less: not ahead
  double along_m = 0.0;   ///< deviation from a whole number of slots
  double beside_m = 0.0;  ///< lateral deviation, positive to the left
  double spacing_m = 0.0;
};

/// Returns the step between two trees, in the direction and spacing at both.
RowStep row_step(const std::vector<Eigen::Vector2d>& p_map, const std::vector<LocalRows>& local,
                 std::int32_t from, std::int32_t to);

/// derived: Minimum number of trees of a row: two are always in line.
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
