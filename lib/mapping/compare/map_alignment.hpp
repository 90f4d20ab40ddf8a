// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/pose2.hpp"
#include "mapping/compare/landmark_pairing.hpp"
#include "mapping/compare/visibility.hpp"

namespace orchard::mapping {

/// Configuration of align_maps().
struct MapAlignmentConfig {
  bool any_place = false;      ///< the two frames are unrelated
  double offset_max_m = 5.0;   ///< else: max distance between the two positions of one tree
  double turn_max_deg = 10.0;  ///< and max rotation between the maps
  double gate_m = 0.5;         ///< max distance of a pair after alignment
  int min_pairs = 5;           ///< min number of pairs
};

enum class AlignmentStatus {
  kAligned,    ///< T_a_b is unique
  kAmbiguous,  ///< at least two alignments explain the maps about equally well
  kNone,       ///< no alignment explains them
};

/// Registration of two maps.
struct MapAlignment {
  AlignmentStatus status = AlignmentStatus::kNone;
  geometry::Pose2 T_a_b;                                 ///< best alignment
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw) of T_a_b
  std::vector<LandmarkPair> pairs;  ///< indices into the two lists of landmarks; rigid residuals
  double rms_m = 0.0;               ///< RMS distance of the pairs
  double position_sd_m = 0.0;   ///< of a pair per axis, without deformation shared by neighbours
  double log_odds = 0.0;        ///< best alignment against its strongest rival
  double rival_offset_m = 0.0;  ///< distance of the rival; 0: there is none
  std::string reason;  ///< reason for a status other than kAligned: a sentence without full stop
};

/// Registers map b to map a by positions, widths and gaps of the trunks.
///
/// Rows look alike everywhere (lattice aliasing), so the best of many alignment hypotheses must
/// beat every other one (shifted by a tree or a row, turned by half a circle) by odds of a thousand
/// to one and three standard deviations of the difference (Vuong 1989). An unpaired trunk counts
/// against a hypothesis only within the other drive's field of view; without a detection map,
/// wherever landmarks surround it on all sides. Objects are used only if there are few trees.
/// Deterministic.
MapAlignment align_maps(const std::vector<Landmark>& a, const std::vector<Landmark>& b,
                        const DetectionMap& view_a, const DetectionMap& view_b,
                        const MapAlignmentConfig& config);

}  // namespace orchard::mapping
