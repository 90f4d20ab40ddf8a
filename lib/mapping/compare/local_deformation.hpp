// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

/// Points of b in the frame of a, after removal of the local deformation between the maps, which is
/// the median residual of the neighbouring pairs.
std::vector<Eigen::Vector2d> without_local_deformation(const geometry::IndexedPoints& a,
                                                       const geometry::IndexedPoints& b,
                                                       const MapAlignment& alignment);

}  // namespace orchard::mapping
