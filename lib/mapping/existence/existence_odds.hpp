// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/free_space.hpp"

namespace orchard::mapping {

/// Log odds of existence below which a landmark is dropped (12 %).
inline constexpr double kLogOddsGone = -2.0;

/// Log odds of existence from a returned beam or an observation.
double log_odds_of_return();

/// Weighting of a pass-through by few beams.
enum class BeamWeight {
  kByNumber,  ///< reduced: for consecutive scans, whose pose errors are correlated
  kFull,      ///< full: for scans from all sides
};

/// Log odds of existence from the free-space evidence of one scan.
double log_odds_of(const FreeSpaceAnswer& answer, BeamWeight weight = BeamWeight::kByNumber);

/// Weight of a landmark with `num_observations` observations in validating a scan's pose: a scan
/// that misses more weight than it finds has a wrong pose and is no evidence.
int pose_weight(int num_observations);

}  // namespace orchard::mapping
