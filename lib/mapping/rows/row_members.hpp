// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Weight of each tree in finding rows: its confidence (probability times roc_mean) divided by half
/// the map's median. 1 or more is full strength; posts and parts of bushes mistaken for trees have
/// less.
std::vector<double> row_strengths(const std::vector<const Landmark*>& trees);

/// Indices of the trees of full strength, in order, from which rows are guessed first. Of several
/// trees within a third of the spacing (a bush, two stems) only the strongest is one.
std::vector<std::size_t> seed_trees(const std::vector<Eigen::Vector2d>& p_map,
                                    const std::vector<double>& strengths);

}  // namespace orchard::mapping
