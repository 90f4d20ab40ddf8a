// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// What scans say of a place of map.
using SeenAs = std::function<bool(const Eigen::Vector2d& p_map)>;

/// Joins the parts of what is longer than `widest_m`, the widest thing that a scan reports: of a
/// hedge or a wall the scans show bits, each as a thing of its own.
///
/// Two things are one where nothing was ever seen to pass between them: their borders touch, or
/// every place between, no farther than `widest_m`, was seen to be blocked: scans met something
/// there, too often for it to be free. A straight stretch of such things, no wider than `widest_m`,
/// becomes one object with length and direction, under its lowest id. Stretches in line with each
/// other are one where no way between them was seen free: gates are seen through. What is shorter
/// stays as it is; so do all that `stands_alone` names: trees of rows, and what a camera called a
/// tree. In order of id.
std::vector<Landmark> join_long_things(
    std::vector<Landmark> landmarks, double widest_m, const SeenAs& is_blocked,
    const SeenAs& is_free, const std::function<bool(const Landmark& landmark)>& stands_alone);

/// Places along a landmark's middle line, so near to each other that discs of its width cover it;
/// of a round one its position.
std::vector<Eigen::Vector2d> middle_line(const Landmark& landmark);

}  // namespace orchard::mapping
