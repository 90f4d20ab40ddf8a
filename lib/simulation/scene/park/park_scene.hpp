// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/park/park_config.hpp"
#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Makes a park: trees of all widths, in groups and alone, and bushes, all clear of the car's path
/// (make_park_path).
Scene make_park_scene(std::uint64_t seed, const ParkConfig& config);

}  // namespace orchard::simulation
