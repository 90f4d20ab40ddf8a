// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/scene.hpp"
#include "simulation/scene/yard/yard_config.hpp"

namespace orchard::simulation {

/// What a robot passes between blocks: a small block of rows, a shed with a lean-to and things
/// beside it, hedges with rough faces, scattered trees; 1.5 km of way that comes back to most
/// places from both sides. Trees are the truth's trees; walls, hedges and crates are scenery.
Scene make_yard_scene(std::uint64_t seed, const YardConfig& config);

}  // namespace orchard::simulation
