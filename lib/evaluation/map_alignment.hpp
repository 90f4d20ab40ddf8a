// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "evaluation/assignment.hpp"
#include "geometry/pose2.hpp"

namespace orchard::evaluation {

/// Limits of the search for the alignment of a map with the truth.
struct AlignmentSearch {
  double offset_max_m = 10.0;  ///< max displacement of a found point
  double turn_max_rad = 0.35;
};

/// Finds T_truth_map with the most found points paired with true ones, one to one within the gate,
/// and among those with the least squared distances. Correspondences are unknown: the
/// best of mapping::alignment_candidates(), the identity, and `guess` if given, are refined by
/// alternating assign() and fit_rigid(), from the centre of the map outwards. None when no points
/// can be paired.
std::optional<geometry::Pose2> align_points(const std::vector<Point>& truth,
                                            const std::vector<Point>& found, double gate_m,
                                            const AlignmentSearch& search,
                                            const std::optional<geometry::Pose2>& guess);

}  // namespace orchard::evaluation
