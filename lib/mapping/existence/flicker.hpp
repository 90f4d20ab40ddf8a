// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Whether a landmark is a stalk of grass or a twig that moves in and out of the scan plane: not a
/// tree, never wider than two beams, and missed between its observations more often than an
/// existing object would be. A scan is a miss if the position is in view and not farther than the
/// farthest observation, even if a single beam was returned.
bool is_flickering(const MapState& map, const LandmarkRecord& record);

}  // namespace orchard::mapping
