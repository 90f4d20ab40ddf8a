// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Test of a map position against the scans.
using SeenAs = std::function<bool(const Eigen::Vector2d& p_map)>;

/// Joins the parts of objects longer than `widest_m`, the width of the widest object that a scan
/// reports: scans show a hedge or wall as separate parts.
///
/// Two landmarks are parts of one object if their borders touch, or if all positions between them,
/// over at most `widest_m`, were observed to be blocked. A straight stretch of such landmarks, at
/// most `widest_m` wide and longer than that, becomes one object with length and direction and the
/// lowest id. Stretches in line are joined unless a passage between them was observed free (a
/// gate). Shorter groups are left unchanged, and so are landmarks for which `stands_alone` is true:
/// trees of rows and trees by a camera. Returned in order of id.
std::vector<Landmark> join_long_things(
    std::vector<Landmark> landmarks, double widest_m, const SeenAs& is_blocked,
    const SeenAs& is_free, const std::function<bool(const Landmark& landmark)>& stands_alone);

/// Positions along a landmark's centre line, so close that discs of its width cover it; for a round
/// one its position.
std::vector<Eigen::Vector2d> middle_line(const Landmark& landmark);

}  // namespace orchard::mapping
