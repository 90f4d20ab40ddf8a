// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mapping/compare/map_comparison.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// How trunks that both maps measured have changed.
struct Growth {
  int num_pairs = 0;
  double tcsa_before_cm2 = 0.0;  ///< of those trees together
  double tcsa_change_cm2 = 0.0;
  double percent() const {
    return tcsa_before_cm2 > 0.0 ? 100.0 * tcsa_change_cm2 / tcsa_before_cm2 : 0.0;
  }
};

/// By rows of the later map, 0 for no row; of all together under kGrowthOfAll.
inline constexpr std::int32_t kGrowthOfAll = -1;
using GrowthByRow = std::map<std::int32_t, Growth>;

/// Of the trees that are the same in both (unchanged, moved, grown, thinner) and have a width in
/// both. `comparison` is of `earlier` (a) and `later` (b).
GrowthByRow growth_by_row(const std::vector<Landmark>& earlier, const std::vector<Landmark>& later,
                          const MapComparison& comparison);

}  // namespace orchard::mapping
