// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "mapping/landmark.hpp"
#include "mapping/rows/rows.hpp"

namespace orchard::mapping {

/// The stem of a plant at the place where the observations of its trees (ids) are densest, in the
/// map frame [m]; without a tree, of its parts.
using CommonPlace =
    std::function<Landmark(const Landmark& stem, const std::vector<std::int32_t>& trees)>;

/// Joins the parts of each plant: stems, suckers, shoots and the whole of it, as scans from several
/// sides cut it. In order of id.
///
/// A scan cannot tell two stems of one plant from two plants; the planting does. What stands within
/// a third of the spacing of this map's rows is one plant, if what stands so near to the trees in
/// rows is itself a tree more than half as often as any landmark: its most often seen tree, at the
/// common place of its trees (without a tree, its most often seen part, at that of its parts).
/// Hedges and walls are no parts. Maps without rows and those whose landmarks stand apart are left
/// as they are.
std::vector<Landmark> join_plants(std::vector<Landmark> landmarks, const RowsConfig& config,
                                  const CommonPlace& place);

}  // namespace orchard::mapping
