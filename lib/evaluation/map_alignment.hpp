// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "evaluation/assignment.hpp"
#include "geometry/pose2.hpp"

namespace orchard::evaluation {

/// How far a map may lie from the truth that it is to be laid upon.
struct AlignmentSearch {
  double offset_max_m = 10.0;  ///< of the map's middle
  double turn_max_rad = 0.35;  ///< about its middle
};

/// T_truth_map that lays most found points on true ones, one to one within the gate, and of those
/// the one with the least squared distances. Who belongs to whom is not known: offsets are voted
/// for by all pairs at every turn of the search, and the best, the identity, and `guess` if there
/// is one are refined by turns of assign() and fit_rigid(), from the middle of the map outwards.
/// None when nothing lies upon anything.
std::optional<geometry::Pose2> align_points(const std::vector<Point>& truth,
                                            const std::vector<Point>& found, double gate_m,
                                            const AlignmentSearch& search,
                                            const std::optional<geometry::Pose2>& guess);

}  // namespace orchard::evaluation
