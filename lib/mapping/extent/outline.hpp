// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// What a landmark covers of the ground: the border, counter-clockwise in map [m], of a disc of its
/// width; of a hedge or a wall, of all that such a disc covers along it. Empty without a width.
std::vector<Eigen::Vector2d> outline_of(const Landmark& landmark);

}  // namespace orchard::mapping
