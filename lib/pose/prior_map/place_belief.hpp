// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "pose/field_of_view.hpp"
#include "pose/prior_map/pattern_evidence.hpp"
#include "pose/prior_map/place_likelihood.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// T_map_base in a prior map where one trunk cannot be told from the next: a sum of Gaussians, one
/// for each place where base may be. Places at which the trunks fit alike keep their share until
/// ends of rows, gaps and lone trunks decide.
class PlaceBelief {
 public:
  explicit PlaceBelief(const PriorMap& map);
  PlaceBelief(const PlaceBelief&) = delete;  // its test refers to its likelihood
  PlaceBelief& operator=(const PlaceBelief&) = delete;

  /// Starts from a Gaussian.
  void start(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);
  /// Starts from a place that somebody stated: one in ten of these is off by some spacings.
  void start_stated(const Eigen::Vector3d& T_map_base, const Eigen::Matrix3d& covariance);

  /// Starts anywhere within `reach_m` [m] of a landmark, with any heading. False, and no change,
  /// where these are more places than can be weighed.
  bool start_anywhere(double reach_m);

  /// Moves all places by T_base_next (x [m], y [m], yaw [rad]) with its covariance; `travel_m`: the
  /// length of the way.
  void move(const Eigen::Vector3d& T_base_next, const Eigen::Matrix3d& covariance, double travel_m);

  /// Tells that a motion since the last correction was not confirmed: one in ten of such is off by
  /// a spacing.
  void doubt_motion() { is_motion_doubted_ = true; }

  /// Corrects the places by a scan, in proportion to the travel since the scan that last did: a
  /// trunk in view for long counts once. Returns false before a third of a metre, without a change.
  bool correct(const std::vector<ScanObservation>& observations, const FieldOfView& field);

  /// The most probable place, with all Gaussians less than half a spacing from it; its weight is
  /// its probability.
  const WeighedPlace& place() const { return place_; }
  /// What the scans since it is the most probable tell of it against parts of another orchard.
  const PatternEvidence& pattern() const { return pattern_; }
  /// The probability of all places less than half a spacing from the pose, as of the last
  /// correction.
  double probability_at(const Eigen::Vector3d& T_map_base) const;
  std::size_t num_places() const { return places_.size(); }
  /// True where base may be at more places than can be weighed.
  bool is_spread_out() const;

 private:
  void begin(std::size_t places_max);
  void doubt(double spacings);
  void move_places();
  void split();
  bool split(std::size_t place);
  void merge();
  void prune();
  WeighedPlace sum_around(const Eigen::Vector3d& T_map_base) const;

  const PriorMap& map_;
  PlaceLikelihood likelihood_;
  double place_sd_m_, place_sd_rad_;  ///< of a Gaussian, at most
  PatternEvidence pattern_;
  std::vector<WeighedPlace> places_;
  std::size_t places_max_ = 0;
  WeighedPlace place_;
  // Since the last correction.
  double travel_m_ = 0.0;
  WeighedPlace since_;
  bool is_motion_doubted_ = false;
};

}  // namespace orchard::pose
