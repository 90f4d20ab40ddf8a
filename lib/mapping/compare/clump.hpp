// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// What stands so close together that it passes for parts of one thing.
struct ThicketConfig {
  double near_m = 0.5;     ///< two others this near make a landmark part of a bush or heap
  double reach_m = 0.8;    ///< how far the parts of one stand from each other at most
  double stake_m = 0.045;  ///< thinner things stand beside trees as they please
};

/// Which landmarks stand so close together that they are parts of one thing, or might be taken for
/// each other: at least two others near, stakes and stalks not counted. Each look at a bush shows
/// other parts of it, so what such a landmark is, and where, says little.
std::vector<char> in_thickets(const std::vector<Landmark>& landmarks, const ThicketConfig& config);

}  // namespace orchard::mapping
