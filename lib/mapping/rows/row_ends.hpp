// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Cuts off the ends of rows that deviate from the line of the five trees before them by more than
/// trees of this map's rows do: a person, a post or the hedge at the headland. Curved rows deviate
/// at every tree and are not cut.
void trim_row_ends(const std::vector<Eigen::Vector2d>& p_map, double spacing_m,
                   std::vector<RowChain>& chains);

}  // namespace orchard::mapping
