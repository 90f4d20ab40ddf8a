// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Sorts chains from left to right as seen along the rows, by lateral adjacency, so that the order
/// is right for curved rows.
void order_from_left(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                     std::vector<RowChain>& chains);

}  // namespace orchard::mapping
