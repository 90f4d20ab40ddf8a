// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

/// Where points of b lie in the frame of a, the maps' bend against each other taken out.
std::vector<Eigen::Vector2d> straightened(const IndexedPoints& a, const IndexedPoints& b,
                                          const MapAlignment& alignment);

}  // namespace orchard::mapping
