// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mapping/rows/row_direction.hpp"

namespace orchard::mapping {

/// Maximum turn of a row between two trees (cosine of 30 degrees).
inline constexpr double kTurnMax_cos = 0.866;

/// Indices of the trees of one row, in order along its direction.
using RowChain = std::vector<std::int32_t>;

/// Index of a chain's element in the list of all trees.
inline std::size_t index_of(std::int32_t tree) { return static_cast<std::size_t>(tree); }

/// Links trees that follow each other in a row. Short links are made first, so that a gap of
/// missing trees is bridged only where no nearer tree fits. Gaps up to `gap_max_spacings`.
std::vector<RowChain> row_chains(const std::vector<Eigen::Vector2d>& p_map,
                                 const RowDirections& rows, double gap_max_spacings);

}  // namespace orchard::mapping
