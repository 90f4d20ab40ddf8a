// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/row_chains.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// Sorts chains from left to right as seen along the rows, by lateral adjacency, so that the order
/// is right for curved rows.
void order_from_left(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                     std::vector<RowChain>& chains);

/// Slot index of every tree of every chain, from 0, counting empty slots: inside a chain by the
/// local spacing; before its first tree by the starts of the neighbouring chains, so that missing
/// first trees are counted. `chains` must be in lateral order.
std::vector<std::vector<int>> slot_indices(const std::vector<Eigen::Vector2d>& p_map,
                                           const std::vector<RowChain>& chains);

/// The rows of a numbered map, in order of number.
///
/// A function of row, position and place of the trees alone, so that every file, page and message
/// of a map shows the same rows and empty slots, however it was stored and corrected. Empty slots
/// lie evenly between the trees on either side. A tree with a row but no position stands between
/// the trees that it lies between. At most kSlotsMax slots are added to a row, because a map from
/// outside may hold any numbers.
std::vector<Row> numbered_rows(const std::vector<Landmark>& landmarks);

/// derived: a row of 100 km; bounds the memory of a map from outside.
inline constexpr int kSlotsMax = 100'000;

/// Numbers the trunk nearest to each empty slot within kOnePlace_spacings of the row's spacing that
/// has no number yet: what stands there is the tree of that slot, however far beside the line of
/// the row it was planted.
void number_trunks_in_gaps(std::vector<Landmark>& landmarks);

/// Numbers trees that were added to a numbered map, those without a row for which `is_added` is
/// true; nothing else changes.
///
/// Such a tree takes the nearest slot within half of a row's spacing, an empty one or one that
/// continues the row beyond its end. Where the nearest slot holds another tree it gets the row
/// without a position. A tree beside no row stays without.
void number_added_trees(std::vector<Landmark>& landmarks,
                        const std::function<bool(const Landmark& landmark)>& is_added);

}  // namespace orchard::mapping
