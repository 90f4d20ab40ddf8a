// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "mapping/map_state.hpp"
#include "mapping/map_update.hpp"

namespace orchard::mapping {

// Optional stage: landmark splitting. Gates that are wide enough for poses that are off by
// decimetres take two things for one where they stand nearer than that. One scan is free of pose
// errors: what scans show at two positions at once, time and again, is two things.

/// Splits each changed landmark that holds the observations of two things more than
/// `mapper.split_distance_m` apart; adds the new landmark to the update. Does nothing where gate_m
/// is half of split_distance_m or less: no landmark can then hold two.
void split_landmarks(MapState& map, MapUpdate& update);

/// Whether scans show two landmarks at once, so that they must not be merged.
bool are_two_landmarks(const MapState& map, std::int32_t a, std::int32_t b);

}  // namespace orchard::mapping
