// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "mapping/free_space.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Test of a map position against the scans.
using PositionTest = std::function<bool(const Eigen::Vector2d& p_map)>;

/// Evidence of the scans at a passage between two positions in map [m]. `half_depth_m`: of the
/// passage, to each side of the line between them; `clear_m`: how far a beam through it goes on.
using PassageTest =
    std::function<Passage(const Eigen::Vector2d& from_map, const Eigen::Vector2d& to_map,
                          double half_depth_m, double clear_m)>;

/// Joins the parts of objects longer than `object_width_max_m`, the width of the widest object that
/// a scan reports: scans show a hedge or wall as separate parts.
///
/// Two landmarks are parts of one object if their borders touch, or if every passage between them,
/// over at most `object_width_max_m`, was observed to be shut; but not if a passage anywhere
/// between their positions was observed open. A straight part of such landmarks, at most
/// `object_width_max_m` wide and longer than that, becomes one object with length and direction and
/// the lowest id. Stretches in line are joined unless a passage between them was observed free (a
/// gate). What stands in the outline of the whole, or in line with it a little beyond, is part of
/// it. Shorter groups are left unchanged, and so are landmarks for which `is_separate` is true:
/// trees of rows and trees by a camera. Returned in order of id.
std::vector<Landmark> join_long_objects(
    std::vector<Landmark> landmarks, double object_width_max_m, const PassageTest& passage,
    const PositionTest& is_free, const std::function<bool(const Landmark& landmark)>& is_separate);

/// Positions along a landmark's centre line, so close that discs of its width cover it; for a round
/// one its position.
std::vector<Eigen::Vector2d> centre_line(const Landmark& landmark);

}  // namespace orchard::mapping
