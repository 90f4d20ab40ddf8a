// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Weight of each tree in finding rows: its confidence (probability times roc_mean) divided by half
/// the map's median. 1 or more is full strength; posts and parts of bushes mistaken for trees have
/// less.
std::vector<double> row_strengths(const std::vector<const Landmark*>& trees);

/// Partition of the trees into seed trees and weak ones. `seeds`: seed trees of full strength.
/// `rest`: weaker trees, which may join a row but not start one. Of several trees within a third of
/// the spacing (a bush, two stems) only the strongest is kept.
struct SeedTrees {
  std::vector<std::size_t> seeds;
  std::vector<std::size_t> rest;
};
SeedTrees seed_trees(const std::vector<Eigen::Vector2d>& p_map,
                     const std::vector<double>& strengths);

/// Inserts the trees `rest` (indices) into the chains whose line they are on: between two elements,
/// or beyond an end by up to 1.5 spacings. Other trees are dropped. `rows`: directions of all
/// trees.
void join_weak_trees(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                     const std::vector<std::size_t>& rest, std::vector<RowChain>& chains);

/// Merges two chains where one ends near the start of the other and in its line: trees between
/// slots had broken the row there. Sorts the merged trees along the row.
void bridge_chain_gaps(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                       std::vector<RowChain>& chains);

/// Selects the trees of a chain that stand in slots, whole spacings apart; those between slots are
/// posts or bushes. Maximises the total strength minus the deviation from the spacing of the
/// full-strength trees.
RowChain select_trees_in_slots(const std::vector<Eigen::Vector2d>& p_map,
                               const std::vector<double>& strengths, const RowChain& chain);

}  // namespace orchard::mapping
