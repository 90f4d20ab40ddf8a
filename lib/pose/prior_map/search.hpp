// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "pose/prior_map/score.hpp"

namespace orchard::pose {

/// Farthest two trunks whose distance begins a hypothesis [m]: dead reckoning between them is
/// still sure.
inline constexpr double kHypothesisPairMax_m = 8.0;

/// Natural log likelihood ratio of another orchard of such rows against a position, at which the
/// position is given up (1 in 55).
inline constexpr double kLostLogFit = 4.0;

/// What a search of the whole prior map has found.
struct SearchResult {
  std::vector<Place> places;  ///< distinct ones by falling score; those far below the best left out
  double log_odds = 0.0;      ///< of the best against all others together
  double log_fit = 0.0;       ///< of the best against this being no place of the map
};

/// Looks for the places of the prior map that explain the local evidence. Pairs of trunks are laid
/// on the map's pairs of the same distance, and each place that follows is scored by all trunks.
/// Work comes in portions, so that no scan costs more than the others.
class PriorMapSearch {
 public:
  PriorMapSearch(const PriorMap& map, const PriorMapConfig& config, LocalEvidence evidence);

  /// Tries so many hypotheses; true when none is left.
  bool step(int num_hypotheses);

  SearchResult result() const;

  std::size_t num_hypotheses() const { return num_hypotheses_; }

 private:
  struct Seed {
    int first = 0, second = 0;       ///< trunks
    std::size_t begin = 0, end = 0;  ///< of the map's pairs
    std::vector<int> order;          ///< of the other trunks
  };

  void choose_seeds();
  void try_hypothesis(const Seed& seed, std::int32_t first, std::int32_t second);
  void keep(Place place);

  const PriorMap& map_;
  PriorMapConfig config_;
  PlaceScorer scorer_;
  std::vector<Seed> seeds_;
  std::size_t seed_ = 0;       ///< that is being tried
  std::size_t next_pair_ = 0;  ///< of its range
  std::size_t num_hypotheses_ = 0;
  std::vector<Place> places_;
};

}  // namespace orchard::pose
