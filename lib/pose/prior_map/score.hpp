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

/// Snapshot of the local map, in its frame.
struct LocalEvidence {
  std::vector<LocalTrunkMap::Trunk> trunks;  ///< the last seen first
  std::deque<LocalTrunkMap::View> views;
  FieldOfView field;
};

/// Hypothesis of the pose in the prior map, with its score by the local evidence.
struct PoseHypothesis {
  Eigen::Vector3d T_map_base = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Log-likelihood ratio of the evidence at this pose against another orchard with the same
  /// planting pattern. Each trunk counts once: matched, new or missing.
  double score = 0.0;
  std::vector<std::int32_t> matched;  ///< landmarks
  int num_new = 0;
  int num_missing = 0;
};

/// Scores pose hypotheses in the prior map by the local evidence.
class HypothesisScorer {
 public:
  HypothesisScorer(const PriorMap& map, const PriorMapConfig& config, LocalEvidence evidence);

  const LocalEvidence& evidence() const { return evidence_; }

  /// Matches the trunks in this order, starting from a pose with its covariance. Each match
  /// corrects the pose by a Kalman update; process noise between trunks models the distortion of
  /// the local map. None if the score falls below `score_min`. Does not count missing landmarks.
  std::optional<PoseHypothesis> fit(const PoseHypothesis& start, const std::vector<int>& order,
                                    double score_min = -1e300) const;

  /// Subtracts from the score for landmarks that should have been seen at this pose and were not.
  void count_missing(PoseHypothesis& hypothesis) const;

  /// Returns the log-likelihood ratio of two widths being of the same trunk or of two trunks.
  double width_evidence(const LocalTrunkMap::Trunk& trunk, const PriorLandmark& landmark) const;

  /// Returns the indices of all trunks, by ascending distance from a point in the local frame.
  std::vector<int> order_from(const Eigen::Vector2d& p_local) const;

 private:
  /// True if a trunk is within the clump reach of a landmark: probably another part of its clump.
  bool stands_near(const PoseHypothesis& hypothesis, std::int32_t landmark) const;

  /// Returns the probability that the map contains a trunk, if the earlier drive looked there.
  double repeat(const LocalTrunkMap::Trunk& trunk) const;

  const PriorMap& map_;
  PriorMapConfig config_;
  LocalEvidence evidence_;
  double position_variance_;  ///< of a trunk relative to its landmark [m2]
  double gate_radius_m_;
};

}  // namespace orchard::pose
