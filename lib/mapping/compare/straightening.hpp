// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/compare/map_alignment.hpp"

namespace orchard::mapping {

/// Points of b in the frame of a after non-rigid residual removal: the local deformation of one map
/// against the other is the median residual of the neighbours.
std::vector<Eigen::Vector2d> aligned_locally(const IndexedPoints& a, const IndexedPoints& b,
                                             const MapAlignment& alignment);

}  // namespace orchard::mapping
