// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pose/prior_map/score.hpp"

namespace orchard::pose {

/// Max distance of two trunks that start a hypothesis [m]: dead reckoning between them is accurate.
inline constexpr double kHypothesisPairMax_m = 8.0;

/// Natural log-likelihood ratio of another orchard with the same planting pattern against a
/// position, above which the position is contradicted (1 in 55).
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

  std::size_t num_hypotheses() const { return num_hypotheses_; }

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
  std::size_t num_hypotheses_ = 0;
  std::vector<PoseHypothesis> hypotheses_;
};

}  // namespace orchard::pose
