// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/scene.hpp"
#include "simulation/scene/yard/yard_config.hpp"

namespace orchard::simulation {

/// Makes a yard between blocks: a small block of rows, a shed with a lean-to and objects beside it,
/// hedges with rough faces, scattered trees; a path of 1.5 km that revisits most places from both
/// sides. Only the trees are in the truth as trees; walls, hedges and crates are scenery.
Scene make_yard_scene(std::uint64_t seed, const YardConfig& config);

}  // namespace orchard::simulation
