// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Parameters of clumps: landmarks so close together that they may be parts of one object.
struct ClumpConfig {
  double near_m = 0.5;     ///< two other landmarks within this distance make a clump
  double reach_m = 0.8;    ///< max distance between parts of one clump
  double stake_m = 0.045;  ///< thinner ones are stakes, which do not count
};

/// Whether each landmark is part of a clump: at least two others nearby, not counting stakes and
/// stalks. Each drive observes different parts of a bush, so such landmarks are not reproducible.
std::vector<char> in_clumps(const std::vector<Landmark>& landmarks, const ClumpConfig& config);

}  // namespace orchard::mapping
