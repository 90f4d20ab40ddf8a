// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

struct MapState;

/// Landmarks whose observations disagree on the class.
struct LabelConflicts {
  int num_conflicting = 0;      ///< landmarks whose fraction of TREE labels supports neither class
  int num_with_tree_label = 0;  ///< landmarks with at least one TREE label
};

/// Counts over landmarks with at least ten judged observations; uses the newest 512 of each.
LabelConflicts count_label_conflicts(const MapState& map);

}  // namespace orchard::mapping
