// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Slot index of every tree of every chain, from 0, counting empty slots: inside a chain by the
/// local spacing; before its first tree by the starts of the neighbouring chains, so that missing
/// first trees are counted. `chains` must be in lateral order.
std::vector<std::vector<int>> slot_indices(const std::vector<Eigen::Vector2d>& p_map,
                                           const std::vector<RowChain>& chains);

/// Distance of neighbouring slots from the steps between successive trees: the median of the single
/// steps. Needs at least one step.
double single_step_m(std::vector<double> steps_m);

/// Median distance between neighbouring slots of a chain [m].
double slot_spacing_m(const std::vector<Eigen::Vector2d>& p_map, const RowChain& chain,
                      const std::vector<int>& positions);

}  // namespace orchard::mapping
