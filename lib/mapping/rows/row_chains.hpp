// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/rows/row_direction.hpp"

namespace orchard::mapping {

/// A row does not turn by more than this (cosine of 30 degrees) from one tree to the next.
inline constexpr double kTurnMax_cos = 0.866;

/// Indices of the trees of a row, in order along its direction.
using RowChain = std::vector<std::int32_t>;

/// Links trees that follow each other in their rows, near ones first, so that a gap of missing
/// trees is closed only by what no nearer tree claims. Gaps up to `gap_max_spacings`.
std::vector<RowChain> row_chains(const std::vector<Eigen::Vector2d>& p_map,
                                 const RowDirections& rows, double gap_max_spacings);

}  // namespace orchard::mapping
