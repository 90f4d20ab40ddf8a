// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/pose2.hpp"
#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {

/// Search window for T_a_b.
struct AlignmentSearch {
  bool any_place = false;     ///< any offset and rotation; else the limits below
  double offset_max_m = 5.0;  ///< max displacement of a point of b
  double turn_max_rad = 0.2;
  double gate_m = 0.5;  ///< max distance of a pair
};

/// An alignment hypothesis.
struct AlignmentCandidate {
  geometry::Pose2 T_a_b;
  std::vector<LandmarkPair> pairs;
};

struct AlignmentCandidates {
  std::vector<AlignmentCandidate> candidates;  ///< in descending number of pairs
  double num_tried = 0.0;  ///< number of hypotheses tested, for the multiple-test correction
};

/// Generates alignment hypotheses that register many points of b to points of a: pairs of points
/// from all over a are matched to pairs of equal distance in b and refined with their inliers. If
/// there are too many, keeps those with most inliers and those whose positions and widths [m] agree
/// best. Deterministic.
AlignmentCandidates alignment_candidates(const geometry::IndexedPoints& a,
                                         const std::vector<double>& width_of_a_m,
                                         const geometry::IndexedPoints& b,
                                         const std::vector<double>& width_of_b_m,
                                         const AlignmentSearch& search);

}  // namespace orchard::mapping
