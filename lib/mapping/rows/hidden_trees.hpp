// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Names trees what stands in the empty slots of a numbered map's rows, and numbers it, where it is
/// more probably the tree of the slot, seen as the foliage around its trunk, than something that
/// stands there by chance.
///
/// How far trees stand from the middle between their neighbours is learnt from the rows, how often
/// something stands anywhere from the surroundings of the slot, and how often an empty slot hides
/// its tree from all empty slots of the map (expectation maximisation). Only round objects at least
/// as wide as the trunks of the rows may hide one. Their widths stay those of the foliage. Where
/// all trees stand exactly in the middle none is named. Returns the ids of the trees so named,
/// ascending.
std::vector<std::int32_t> name_trees_in_gaps(std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
