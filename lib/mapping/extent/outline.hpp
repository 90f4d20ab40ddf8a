// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Ground outline of a landmark, counter-clockwise in map [m]: a circle of its width, or for a
/// hedge or wall the area swept by that circle along its length. Empty without a width.
std::vector<Eigen::Vector2d> outline_of(const Landmark& landmark);

}  // namespace orchard::mapping
