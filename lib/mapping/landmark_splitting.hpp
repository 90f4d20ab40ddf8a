// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "mapping/map_state.hpp"

namespace orchard::mapping {

// Optional stage: landmark splitting. With pose errors of decimetres the gates must be wide, and
// two objects closer than the gates become one landmark. A single scan has no pose error: two
// positions that scans repeatedly occupy at the same time are two landmarks.

/// Splits each changed landmark whose observations belong to two objects more than
/// `mapper.split_distance_m` apart, and adds the new landmark to the update. Does nothing if gate_m
/// is at most half of split_distance_m: no landmark can then contain two objects.
void split_landmarks(MapState& map, MapUpdate& update);

/// Whether scans observe the two landmarks at the same time, so that they must not be merged.
bool are_distinct_landmarks(const MapState& map, std::int32_t a, std::int32_t b);

}  // namespace orchard::mapping
