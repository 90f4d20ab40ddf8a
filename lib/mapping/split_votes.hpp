// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace orchard::mapping {

struct MapState;

/// Landmarks whose observations do not agree on a class.
struct SplitVotes {
  int num_split = 0;  ///< TREE as often as tells a tree and an object apart least
  int num_told = 0;   ///< TREE at all
};

/// Of landmarks with ten observations or more that judged them, the newest 512 of each.
SplitVotes split_votes(const MapState& map);

}  // namespace orchard::mapping
