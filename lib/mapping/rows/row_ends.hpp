// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Removes from rows what deviates from the line of its neighbours by more than trees of this map's
/// rows do: ends, judged by the five trees before them, and what stands in an alley beside a gap,
/// judged by three on either side (a person, a post, the hedge at the headland). Curved rows
/// deviate at every tree and are not cut.
void trim_row_ends(const std::vector<Eigen::Vector2d>& p_map, double spacing_m,
                   std::vector<RowChain>& chains);

}  // namespace orchard::mapping
