// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/pose2.hpp"
#include "mapping/compare/coverage.hpp"
#include "mapping/compare/landmark_pairing.hpp"

namespace orchard::mapping {

struct MapAlignmentConfig {
  bool any_place = false;      ///< the two frames have nothing in common
  double offset_max_m = 5.0;   ///< else: how far apart the maps place one tree, at most
  double turn_max_deg = 10.0;  ///< and how far they are turned
  double gate_m = 0.5;         ///< farthest that one tree lies apart after alignment
  int min_pairs = 5;           ///< fewer trees in common are no alignment
};

enum class AlignmentStatus {
  kAligned,    ///< T_a_b is the one answer
  kAmbiguous,  ///< at least two answers explain the maps about equally
  kNone,       ///< no answer explains them
};

/// Registration of two maps.
struct MapAlignment {
  AlignmentStatus status = AlignmentStatus::kNone;
  geometry::Pose2 T_a_b;                                 ///< the best answer
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw) of T_a_b
  std::vector<LandmarkPair> pairs;  ///< indices into the two lists of landmarks; rigid residuals
  double rms_m = 0.0;               ///< of the pairs' distances
  double position_sd_m = 0.0;       ///< of a pair per axis, bends common to neighbours taken out
  double log_odds = 0.0;            ///< of the best answer against its nearest rival
  double rival_offset_m = 0.0;      ///< how far the rival lies off; 0: there is none
  std::string reason;               ///< why not, as a sentence without a full stop
};

/// Registers map b to map a by the trunks themselves: positions, widths and gaps.
///
/// Rows look alike everywhere (lattice aliasing), so the best of many alignment hypotheses must
/// beat every other one (a shift by a tree, by a row, a turn by half a circle) by odds of a
/// thousand to one and three standard deviations of the difference (Vuong 1989). A trunk without
/// partner counts against a hypothesis only within the other drive's field of view; without a
/// detection map, that is wherever landmarks stand on all sides. Landmarks that are objects take
/// part only where there are few trees. Deterministic.
MapAlignment align_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                        const DetectionMap& view_a, const DetectionMap& view_b,
                        const MapAlignmentConfig& config);

}  // namespace orchard::mapping
