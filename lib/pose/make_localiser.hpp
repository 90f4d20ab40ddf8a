// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "laser/blind_sector.hpp"
#include "laser/laser_config.hpp"
#include "pose/graph/chunk_memory.hpp"
#include "pose/localiser.hpp"
#include "pose/measurement.hpp"
#include "pose/pose_config.hpp"
#include "pose/prior_map/prior_map.hpp"

namespace orchard::pose {

/// The localiser of `config.mode`. Mode prior_map needs that map, which is not
/// read here; throws std::invalid_argument when they do not determine a pose. Modes that read scans
/// need the laser's pose on the robot and the sector in which it sees the robot itself. `memory`
/// holds what a long drive leaves; none: the heap. It changes no result.
std::unique_ptr<Localiser> make_localiser(const PoseConfig& config, const EarlierMap& earlier = {},
                                          const laser::LaserConfig& laser = {},
                                          const laser::BlindSector& blind = {},
                                          std::shared_ptr<ChunkMemory> memory = nullptr);

/// The measurements that this localiser uses, and how long to wait for each of them.
MeasurementWaits expected_measurements(const PoseConfig& config);

}  // namespace orchard::pose
