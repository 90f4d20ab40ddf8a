// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Cuts off ends of rows that stand beside the line of the five trees before them, by more than
/// trees of this map's rows do: somebody, a post or the hedge at the headland, half a step aside.
/// Rows that curve all along do so at every tree, and keep theirs.
void cut_ends_beside(const std::vector<Eigen::Vector2d>& p_map, double spacing_m,
                     std::vector<RowChain>& chains);

}  // namespace orchard::mapping
