// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/stored_map.hpp"
#include "mapping/map_alignment.hpp"

namespace orchard::cli {

/// Where the drives of a map looked; `reach_m` over 0 replaces what the map says.
mapping::DriveView view_of(const io::StoredMap& map, double reach_m);

/// How map b lies on map a. Throws io::FileError in one sentence when that cannot be told.
mapping::MapAlignment lay_on(const io::StoredMap& a, const mapping::DriveView& view_a,
                             const io::StoredMap& b, const mapping::DriveView& view_b,
                             const mapping::MapAlignmentConfig& config);

}  // namespace orchard::cli
