// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "pose/prior_map/place_likelihood.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// Tests whether a place fits better than any part of the same planting pattern would: the robot
/// may be in another orchard, or in a part of this one that is not in the map.
///
/// Rivals are the places, where the map was made, from which another landmark stands where the
/// nearest one stands; they are moved and corrected alike. If the place is no better than they are,
/// then the likelihood of each scan over the mean of all likelihoods is at most 1 in the mean.
/// Their product, in proportion to the travel, is at most the inverse of a probability of error
/// (Ville's inequality).
class PatternEvidence {
 public:
  PatternEvidence(const PriorMap& map, const PlaceLikelihood& likelihood);

  /// Begins anew, with another place.
  void clear();
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance);
  /// Adds a scan, and tells it what things tell where the map was not made; `place`: before it is
  /// corrected by that scan.
  void add(const WeighedPlace& place, PlaceLikelihood::ScanView& scan, double share);

  /// The place is of this map, or it is not; by log-odds of 9 (1 in 8,000).
  bool is_of_map() const { return log_evidence_ >= kLogEvidenceMax; }
  bool is_elsewhere() const { return log_evidence_ <= -kLogEvidenceMax; }

 private:
  static constexpr double kLogEvidenceMax = 9.0;  ///< derived: 1 in 8,000, as elsewhere

  void choose_rivals(const WeighedPlace& place, double range_m);

  const PriorMap& map_;
  const PlaceLikelihood& likelihood_;
  std::vector<WeighedPlace> rivals_;
  double passes_ = 0.0;        ///< of trunks, since the rivals were chosen
  double log_evidence_ = 0.0;  ///< natural logarithm of the product, at most kLogEvidenceMax
};

}  // namespace orchard::pose
