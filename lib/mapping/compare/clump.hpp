// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Clumps: landmarks so close together that they may be parts of one object.
struct ClumpConfig {
  double near_m = 0.5;     ///< two others this near make a landmark part of a bush or heap
  double reach_m = 0.8;    ///< how far the parts of one stand from each other at most
  double stake_m = 0.045;  ///< thinner things stand beside trees as they please
};

/// Whether each landmark is part of a clump: at least two others near, stakes and stalks not
/// counted. Each drive observes other parts of a bush, so such a landmark is not reproducible.
std::vector<char> in_clumps(const std::vector<Landmark>& landmarks, const ClumpConfig& config);

}  // namespace orchard::mapping
