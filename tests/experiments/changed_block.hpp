// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>

#include "mapping/compare/detection_map.hpp"
#include "mapping/compare/map_comparison.hpp"
#include "unit/mapping/compare/two_drives.hpp"

namespace orchard::trials {

using namespace mapping;

/// Shares of the trees to which each happens between two days.
struct DayChanges {
  double felled = 0.05, moved = 0.05, grown = 0.05;  ///< as many are planted as were felled
};

/// What truly happened to each tree of the block, by its index; no entry: nothing. A tree that
/// moved stands half a metre to one and a half farther along its row, one that grew is 20 to 60 mm
/// wider (two standard deviations).
inline std::map<int, Change> change_block(Block& block, const DayChanges& fraction, Dice& dice) {
  std::map<int, Change> truth;
  int num_felled = 0;
  std::vector<int> gaps;
  for (std::size_t i = 0; i < block.trees.size(); ++i) {
    TrueTree& t = block.trees[i];
    const int index = static_cast<int>(i);
    if (!t.stands) {
      gaps.push_back(index);
      continue;
    }
    const double die = dice.uniform(0, 1);
    if (die < fraction.felled) {
      t.stands = false;
      truth[index] = Change::kMissing;
      ++num_felled;
    } else if (die < fraction.felled + fraction.moved) {
      const double way_m = dice.uniform(0.5, 1.5) * (dice.uniform(0, 1) < 0.5 ? 1.0 : -1.0);
      const Eigen::Vector2d p = t.p + Eigen::Vector2d(way_m, dice.normal(0.05));
      const bool is_free = std::all_of(
          block.trees.begin(), block.trees.end(),
          [&](const TrueTree& o) { return &o == &t || !o.stands || (o.p - p).norm() > 0.4; });
      if (!is_free) continue;
      t.p = p;
      truth[index] = Change::kMoved;
    } else if (die < fraction.felled + fraction.moved + fraction.grown) {
      t.width_m += std::max(0.01, 0.04 + dice.normal(0.01));
      truth[index] = Change::kGrown;
    }
  }
  for (int planted = 0; planted < num_felled && !gaps.empty(); ++planted) {
    const auto k = static_cast<std::size_t>(dice.uniform(0, 1) * gaps.size());
    const int index = gaps[k];
    gaps.erase(gaps.begin() + static_cast<std::ptrdiff_t>(k));
    TrueTree& t = block.trees[static_cast<std::size_t>(index)];
    const bool is_free =
        std::all_of(block.trees.begin(), block.trees.end(),
                    [&](const TrueTree& o) { return !o.stands || (o.p - t.p).norm() > 0.4; });
    if (!is_free) continue;
    t.stands = true;
    truth[index] = Change::kNew;
  }
  return truth;
}

inline DetectionMap view_of(const DrivenMap& map) {
  SensorView view;
  view.reach_m = 8.0;  // more than the drives truly have: that is for the map to tell
  return DetectionMap(map.landmarks, {map.trajectory}, view);
}

}  // namespace orchard::trials
