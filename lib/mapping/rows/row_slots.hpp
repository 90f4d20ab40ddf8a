// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {

/// Place of every tree of every chain, counted from 0 and with the empty places: inside a chain by
/// the local spacing; before its first tree by where the neighbouring chains begin, so that a row
/// whose first tree is missing begins at 1. `chains` in order across.
std::vector<std::vector<int>> positions_of(const std::vector<Eigen::Vector2d>& p_map,
                                           const std::vector<RowChain>& chains);

/// Distance of neighbouring places, of the steps between trees that follow each other: the median
/// of the single ones. At least one step.
double single_step_m(std::vector<double> steps_m);

/// Median distance between neighbouring places of a chain [m].
double place_spacing_m(const std::vector<Eigen::Vector2d>& p_map, const RowChain& chain,
                       const std::vector<int>& positions);

}  // namespace orchard::mapping
