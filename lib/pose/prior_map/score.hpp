// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "pose/prior_map/local_map.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// What the last metres of travel showed, frozen: in the frame of base as it was then.
struct LocalEvidence {
  std::vector<LocalTrunkMap::Trunk> trunks;  ///< the one seen last first
  std::deque<LocalTrunkMap::View> views;
  SightField field;
};

/// A place in the prior map that base may have, and how well it explains the evidence.
struct Place {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Log of how much likelier the evidence is here than in another orchard whose trees stand in
  /// just such rows: every trunk counts once, matched, new or missing.
  double score = 0.0;
  std::vector<std::int32_t> matched;  ///< landmarks
  int num_new = 0;
  int num_missing = 0;
};

/// Holds local evidence against places of the prior map.
class PlaceScorer {
 public:
  PlaceScorer(const PriorMap& map, const PriorMapConfig& config, LocalEvidence evidence);

  const LocalEvidence& evidence() const { return evidence_; }

  /// Matches the evidence's trunks in this order, beginning from a place with its covariance; each
  /// match makes the place surer for the next one, while the local map may bend on the way. None
  /// once the score has fallen below `score_min`. Missing trunks are not counted.
  std::optional<Place> fit(const Place& start, const std::vector<int>& order,
                           double score_min = -1e300) const;

  /// Counts the landmarks that should have been seen from there and were not.
  void count_missing(Place& place) const;

  /// Log-likelihood ratio of two widths being one trunk's rather than two trunks'.
  double width_evidence(const LocalTrunkMap::Trunk& trunk, const PriorLandmark& landmark) const;

  /// The order of all trunks by distance from a point of the local frame.
  std::vector<int> order_from(const Eigen::Vector2d& p_local) const;

 private:
  /// Whether some trunk is within a clump's reach of a landmark: another part of what stands there.
  bool stands_near(const Place& place, std::int32_t landmark) const;

  /// Probability that the map holds a trunk, where the earlier drive looked.
  double repeat(const LocalTrunkMap::Trunk& trunk) const;

  const PriorMap& map_;
  PriorMapConfig config_;
  LocalEvidence evidence_;
  double position_variance_;  ///< of a trunk against its landmark [m2]
  double gate_radius_m_;
};

}  // namespace orchard::pose
