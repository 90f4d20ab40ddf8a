// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/existence/seen_ground.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Indices of landmarks that most likely never stood there, in rising order: seen now and then,
/// while most scans of the drive with a view of their place, before and after, passed through it;
/// or overlapping a trunk or post that was seen more than ten times as often.
///
/// The filter beside it (existence.hpp) weighs what comes after a landmark's first observation, as
/// it comes; this weighs the whole drive, by the same rates, when the map is written. Landmarks of
/// many observations are the filter's alone, and so is every landmark where no scan passes.
std::vector<std::int32_t> stray_landmarks(const MapState& map, SeenGround& ground);

}  // namespace orchard::mapping
