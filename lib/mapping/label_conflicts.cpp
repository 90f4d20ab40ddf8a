// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/label_conflicts.hpp"

#include <cmath>

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {
namespace {

/// Minimum number of judged observations.
constexpr int kObservationsMin = 10;

}  // namespace

LabelConflicts count_label_conflicts(const MapState& map) {
  using detection::Label;
  const TreeRates rates = tree_rates(map.config);
  // `neither`: fraction of TREE labels with no evidence either way. The votes are split when the
  // fraction is nearer to it than to the rates of both classes.
  const double for_tree = std::log(rates.of_trees / rates.of_objects);
  const double for_object = std::log((1.0 - rates.of_objects) / (1.0 - rates.of_trees));
  const double neither = for_object / (for_tree + for_object);
  const double least = 0.5 * (neither + rates.of_objects);
  const double most = 0.5 * (neither + rates.of_trees);
  LabelConflicts votes;
  for (std::int32_t i = 0; i < map.landmarks.num_indices(); ++i) {
    const LandmarkRecord& r = map.landmarks[i];
    if (r.is_removed || r.num_observations < kObservationsMin) continue;
    int num_tree = 0, num_judged = 0;
    for (const std::int32_t k :
         map.observations.newest_of(r.last_observation, kPositionSamplesMax)) {
      const auto label = static_cast<Label>(map.observations[k].label);
      if (label == Label::kUnseen) continue;
      ++num_judged;
      if (label == Label::kTree) ++num_tree;
    }
    if (num_judged < kObservationsMin || num_tree == 0) continue;
    ++votes.num_with_tree_label;
    const double fraction = static_cast<double>(num_tree) / num_judged;
    if (fraction > least && fraction < most) ++votes.num_conflicting;
  }
  return votes;
}

}  // namespace orchard::mapping
