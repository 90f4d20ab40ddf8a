// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
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

/// Max distance of two trunks that start a hypothesis [m]; derived: dead reckoning between them is
/// accurate.
inline constexpr double kHypothesisPairMax_m = 8.0;
/// Natural log-likelihood ratio of another orchard with the same planting pattern against a
/// position, above which the position is contradicted; derived: 1 in 55.
inline constexpr double kLostLogFit = 4.0;

/// Result of a search of the whole prior map.
struct SearchResult {
  std::vector<PoseHypothesis>
      hypotheses;         ///< distinct, by descending score; those far below the best left out
  double log_odds = 0.0;  ///< of the best against all others together
  double log_fit = 0.0;   ///< of the best against the robot not being in this map
};

/// Searches the prior map for poses that explain the local evidence: pairs of trunks are registered
/// to the map's pairs of the same distance, and each resulting pose is scored by all trunks. The
/// work is divided into steps to bound the cost per scan.
class PriorMapSearch {
 public:
  PriorMapSearch(const PriorMap& map, const PriorMapConfig& config, LocalEvidence evidence);

  /// Tries up to about `num_hypotheses` more; returns true when none is left.
  bool step(int num_hypotheses);

  SearchResult result() const;

 private:
  struct Seed {
    int first = 0, second = 0;       ///< trunks
    std::size_t begin = 0, end = 0;  ///< range of the map's pairs
    std::vector<int> order;          ///< of the other trunks
  };

  void choose_seeds();
  void try_hypothesis(const Seed& seed, std::int32_t first, std::int32_t second);
  void keep(PoseHypothesis hypothesis);

  const PriorMap& map_;
  PriorMapConfig config_;
  HypothesisScorer scorer_;
  std::vector<Seed> seeds_;
  std::size_t seed_ = 0;       ///< seed being tried
  std::size_t next_pair_ = 0;  ///< in the range of this seed
  std::vector<PoseHypothesis> hypotheses_;
};

}  // namespace orchard::pose
