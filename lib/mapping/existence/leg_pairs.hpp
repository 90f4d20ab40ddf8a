// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Ids of landmarks that are most likely legs of people who stood as long as they were seen, in
/// rising order.
///
/// Two things as thin as legs, as far apart as people stand, and no others there; seen together
/// once, for no longer than people stand still. Where trees of the map's own rows stand in such
/// pairs, as double stems do, or where too few rows tell, none is. Trees of rows never are, nor,
/// with `camera_tells`, what a camera called a tree. `landmarks`: of this map, with rows.
std::vector<std::int32_t> leg_pairs(const MapState& map, const std::vector<Landmark>& landmarks,
                                    bool camera_tells);

}  // namespace orchard::mapping
