// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/point_grid.hpp"
#include "geometry/pose2.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Positions of the landmarks, in their order.
std::vector<Eigen::Vector2d> landmark_positions(const std::vector<Landmark>& landmarks);

/// One object in two maps.
struct LandmarkPair {
  std::int32_t a = 0;
  std::int32_t b = 0;
  Eigen::Vector2d residual_m{0.0, 0.0};  ///< T_a_b p_b - p_a
};

/// The RMS distance of the pairs that the standard errors of both maps tell [m]; by indices into
/// these lists. A larger one is an error that the maps do not tell, or of other objects.
double told_rms_m(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                  const std::vector<LandmarkPair>& pairs);

/// Pairs points one to one within `gate_m` after transforming b by T_a_b, nearest pairs first.
/// Returned in order of a.
std::vector<LandmarkPair> pair_landmarks(const geometry::IndexedPoints& a,
                                         const geometry::IndexedPoints& b,
                                         const geometry::Pose2& T_a_b, double gate_m);

/// The same for the points of b within `radius_m` of p_a only.
std::vector<LandmarkPair> pair_landmarks_near(const geometry::IndexedPoints& a,
                                              const geometry::IndexedPoints& b,
                                              const geometry::Pose2& T_a_b, double gate_m,
                                              const Eigen::Vector2d& p_a, double radius_m);

/// The pairs of lists a and b by their indices in other lists of the same landmarks, such as people
/// have corrected: by id, without those that a list lacks.
std::vector<LandmarkPair> pairs_in(const std::vector<LandmarkPair>& pairs,
                                   const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                                   const std::vector<Landmark>& other_a,
                                   const std::vector<Landmark>& other_b);

/// Removes from each residual the median of its neighbours' residuals, i.e. the slow deformation
/// between two maps. Fewer than 12 pairs are left unchanged.
void remove_common_residuals(const geometry::IndexedPoints& a, std::vector<LandmarkPair>& pairs);

/// Points of b in the frame of a, after removal of the local deformation between the maps, which is
/// the median residual of the neighbouring pairs, without the point's own.
std::vector<Eigen::Vector2d> without_local_deformation(const geometry::IndexedPoints& a,
                                                       const geometry::IndexedPoints& b,
                                                       const geometry::Pose2& T_a_b,
                                                       const std::vector<LandmarkPair>& pairs);

/// Max distance of one object's positions in two maps of landmarks at these places [m]: a third of
/// their spacing, 0.1 m to 0.5 m.
double pairing_gate_m(const geometry::IndexedPoints& places);

}  // namespace orchard::mapping
