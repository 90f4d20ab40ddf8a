// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/drive_path.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

inline constexpr double kRowsBegin_m = 4.0;  ///< from the robot's start to the first trees, map y

/// The way through an orchard: up and down every alley from the map's origin on, with half circles
/// beyond the rows' ends. With `laps` it goes on along the headland back to the origin, and round
/// again; `start_anywhere` and section `carry` take effect then too.
DrivePath make_orchard_path(std::uint64_t seed, const OrchardConfig& config,
                            const CarryConfig& carry);

}  // namespace orchard::simulation
