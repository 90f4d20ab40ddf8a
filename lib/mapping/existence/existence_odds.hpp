// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/existence/free_space.hpp"

namespace orchard::mapping {

/// Log odds of existence below which a landmark is dropped (12 %).
inline constexpr double kLogOddsGone = -2.0;

/// Log odds that something stands where a beam returned from, or where it was observed.
double log_odds_of_return();

/// What a pass of few beams across a thing weighs.
enum class BeamWeight {
  kByNumber,  ///< less: for one scan after the other as they come, whose poses err together
  kFull,      ///< as much as of many: for scans from all sides
};

/// Log odds that something stands at a place of which a scan says this.
double log_odds_of(const FreeSpaceAnswer& answer, BeamWeight weight = BeamWeight::kByNumber);

/// What a landmark that was observed so often says of a scan's pose by being found or missed: a
/// scan that misses more than it finds lies elsewhere, and is no evidence.
int pose_weight(int num_observations);

}  // namespace orchard::mapping
