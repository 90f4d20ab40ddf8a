// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/drive_path.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

inline constexpr double kRowsBegin_m = 4.0;  ///< from the robot's start to the first trees, map y

/// Makes the path through an orchard: up and down every alley from the map's origin, with half
/// circles beyond the ends of the rows. With `laps` it returns along the headland to the origin and
/// repeats; only then `start_anywhere` and section `carry` take effect.
DrivePath make_orchard_path(std::uint64_t seed, const OrchardConfig& config,
                            const CarryConfig& carry);

}  // namespace orchard::simulation
