// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "mapping/album/photograph.hpp"
#include "mapping/landmark.hpp"

namespace orchard::mapping {

/// Selects the best photograph of each landmark; photographs belong to the nearest landmark.
/// Returned in order of id. Photographs beyond `max_bytes` are left out: first those of objects,
/// then those of least worth.
std::vector<AlbumEntry> choose_photographs(const std::vector<Landmark>& landmarks,
                                           const std::vector<PlacedPhotograph>& photographs,
                                           std::size_t max_bytes);

}  // namespace orchard::mapping
