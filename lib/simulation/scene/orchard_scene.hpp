// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// Makes an orchard: rows of trees along map y, unevenly spaced, some missing; posts and bushes in
/// the rows; a robot on the path of make_orchard_path().
Scene make_orchard_scene(std::uint64_t seed, const OrchardConfig& config,
                         const CarryConfig& carry = {});

}  // namespace orchard::simulation
