// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mapping/rows/row_tracks.hpp"

namespace orchard::mapping {

/// Removes tracks that are no rows: what stands in line by chance, hedges, and tracks that are too
/// close to a more probable one for the row distance of this orchard. `p_map`: trees in the map
/// frame [m].
void keep_probable_rows(const std::vector<Eigen::Vector2d>& p_map, std::vector<RowTrack>& tracks);

}  // namespace orchard::mapping
