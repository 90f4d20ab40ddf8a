// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Landmarks with this many observations are no stalks.
inline constexpr std::size_t kStalkObservationsMax = 30;

/// All observations of a landmark that may be a stalk of grass or a twig, newest first: not a tree,
/// never wider than two beams, observed less than kStalkObservationsMax times. None for any other.
std::vector<std::int32_t> stalk_observations(const MapState& map, const LandmarkRecord& record);

/// Whether a landmark is a stalk of grass or a twig that moves in and out of the scan plane: not a
/// tree, never wider than two beams, and missed between its observations more often than an
/// existing object would be. A scan is a miss if the position is in view and not farther than the
/// farthest observation, even if a single beam was returned.
bool is_flickering(const MapState& map, const LandmarkRecord& record);

}  // namespace orchard::mapping
