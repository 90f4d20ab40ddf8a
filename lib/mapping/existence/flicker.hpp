// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapping/landmark_record.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Whether a landmark is a stalk of grass or a twig that moves in and out of the scan plane: no
/// tree, never more than two beams wide, and missed between its observations more often than a
/// thing that stands there would be. A scan is a miss when it has a view of the place from no
/// farther than the thing was seen from, whatever a lone beam met there.
bool flickers(const MapState& map, const LandmarkRecord& record);

}  // namespace orchard::mapping
