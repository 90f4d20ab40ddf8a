// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/drive_path.hpp"
#include "simulation/scene/park/park_config.hpp"

namespace orchard::simulation {

/// Makes the path of a car through a park: from the centre to random waypoints, half of them
/// visited before and now reached from another side. The car steers realistically: its curvature is
/// limited by the turning circle, its change of curvature by the speed of the steering wheel.
DrivePath make_park_path(std::uint64_t seed, const ParkConfig& config);

}  // namespace orchard::simulation
