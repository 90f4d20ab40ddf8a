// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "mapping/compare/map_comparison.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Growth of the trunks measured in both maps.
struct Growth {
  int num_pairs = 0;
  double tcsa_before_cm2 = 0.0;  ///< sum over these trees
  double tcsa_change_cm2 = 0.0;
  double percent() const {
    return tcsa_before_cm2 > 0.0 ? 100.0 * tcsa_change_cm2 / tcsa_before_cm2 : 0.0;
  }
};

/// Growth by row of the later map, 0 for no row; the total under kGrowthOfAll.
inline constexpr std::int32_t kGrowthOfAll = -1;
using GrowthByRow = std::map<std::int32_t, Growth>;

/// Computes the growth of the trees found in both maps (unchanged, moved, grown, thinner) with a
/// width in both. `comparison`: of `earlier` (a) and `later` (b).
GrowthByRow growth_by_row(const std::vector<Landmark>& earlier, const std::vector<Landmark>& later,
                          const MapComparison& comparison);

}  // namespace orchard::mapping
