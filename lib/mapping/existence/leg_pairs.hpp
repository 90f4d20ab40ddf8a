// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/map_state.hpp"

namespace orchard::mapping {

/// Ids of landmarks that are most likely legs of people who stood still while they were observed,
/// in ascending order.
///
/// A leg is a landmark as thin as a leg, beside which most scans with a clear view show a second
/// leg at the distance of a stance, with no third object there, observed for no longer than people
/// stand still, in one visit or several. Returns none if trees in the map's rows stand in such
/// pairs too (double stems), or if there are too few trees in rows to judge. Trees in rows are
/// never legs, nor, with `trusts_camera`, are landmarks that a camera labelled TREE. `landmarks`:
/// of this map, with rows.
std::vector<std::int32_t> leg_pairs(const MapState& map, const std::vector<Landmark>& landmarks,
                                    bool trusts_camera);

}  // namespace orchard::mapping
