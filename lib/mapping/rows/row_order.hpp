// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Orders chains from left to right as one looks along the rows: by what stands beside what, so
/// that the order holds for rows that curve.
void order_from_left(const std::vector<Eigen::Vector2d>& p_map, const RowDirections& rows,
                     std::vector<RowChain>& chains);

}  // namespace orchard::mapping
