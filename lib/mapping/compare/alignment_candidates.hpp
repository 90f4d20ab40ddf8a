// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {

/// Search window of T_a_b.
struct AlignmentSearch {
  bool any_place = false;     ///< any offset and any turn; else the limits below
  double offset_max_m = 5.0;  ///< no point of b moves farther than this
  double turn_max_rad = 0.2;
  double gate_m = 0.5;  ///< farthest that a pair may lie apart
};

/// An alignment hypothesis.
struct AlignmentCandidate {
  geometry::Pose2 T_a_b;
  std::vector<LandmarkPair> pairs;
};

struct AlignmentCandidates {
  std::vector<AlignmentCandidate> candidates;  ///< those with most pairs first
  double num_tried = 0.0;                      ///< for the correction of multiple tests
};

/// Generates alignment hypotheses that register many points of b to points of a: two points on two
/// points of equal distance, from all over a, refined with their inliers. Where there are too many,
/// those with most inliers and those whose positions and widths [m] agree best. Deterministic.
AlignmentCandidates alignment_candidates(const IndexedPoints& a,
                                         const std::vector<double>& width_of_a_m,
                                         const IndexedPoints& b,
                                         const std::vector<double>& width_of_b_m,
                                         const AlignmentSearch& search);

}  // namespace orchard::mapping
