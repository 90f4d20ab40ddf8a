// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/inventory/growth.hpp"

#include "mapping/inventory/inventory.hpp"

namespace orchard::mapping {

GrowthByRow growth_by_row(const std::vector<Landmark>& earlier, const std::vector<Landmark>& later,
                          const MapComparison& comparison) {
  GrowthByRow growth;
  growth[kGrowthOfAll];
  for (const MapChange& change : comparison.changes) {
    if (change.a < 0 || change.b < 0) continue;
    const Landmark& before = earlier.at(static_cast<std::size_t>(change.a));
    const Landmark& now = later.at(static_cast<std::size_t>(change.b));
    const bool are_trees =
        before.label == detection::Label::kTree && now.label == detection::Label::kTree;
    if (!are_trees || !(before.width_m > 0.0) || !(now.width_m > 0.0)) continue;
    const double before_cm2 = tcsa_cm2(before.width_m);
    const double change_cm2 = tcsa_cm2(now.width_m) - before_cm2;
    for (const std::int32_t row : {now.row, kGrowthOfAll}) {
      Growth& sum = growth[row];
      ++sum.num_pairs;
      sum.tcsa_before_cm2 += before_cm2;
      sum.tcsa_change_cm2 += change_cm2;
    }
  }
  return growth;
}

}  // namespace orchard::mapping
