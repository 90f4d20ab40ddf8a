// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "mapping/album/photograph.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Gives each landmark the best photograph of what was seen at its place, nearest landmark first;
/// in order of id. What does not fit into `max_bytes` is left out: first objects, then the least
/// telling.
std::vector<AlbumEntry> choose_photographs(const std::vector<Landmark>& landmarks,
                                           const std::vector<PlacedPhotograph>& photographs,
                                           std::size_t max_bytes);

}  // namespace orchard::mapping
