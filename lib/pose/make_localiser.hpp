// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "laser/laser_config.hpp"
#include "pose/graph/chunk_allocator.hpp"
#include "pose/localiser.hpp"
#include "pose/pose_config.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// Creates the localiser of `config.mode`. Mode prior_map needs the map in `earlier`, which the
/// caller has read; throws std::invalid_argument if its landmarks cannot determine a pose. Modes
/// that use scans need the laser's extrinsics and the blind sector, in which it sees the robot
/// itself. `memory` stores old observations of a long drive (null: the heap) and does not affect
/// the results.
std::unique_ptr<Localiser> make_localiser(const PoseConfig& config,
                                          const PriorMapData& earlier = {},
                                          const laser::LaserConfig& laser = {},
                                          const laser::BlindSector& blind = {},
                                          std::shared_ptr<ChunkAllocator> memory = nullptr);

}  // namespace orchard::pose
