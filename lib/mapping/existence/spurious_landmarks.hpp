// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/existence/ground_occupancy.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Indices of landmarks that most likely never existed or did not stay, in ascending order: those
/// with few observations while most scans with a view of their position passed through it, or saw
/// most of their ground free; and foliage of a bush.
///
/// Run when the map is written, with the same rates as the ExistenceFilter, which only weighs scans
/// after a landmark's first observation. Landmarks with many observations are left to that filter.
std::vector<std::int32_t> spurious_landmarks(const MapState& map, GroundOccupancy& ground);

}  // namespace orchard::mapping
