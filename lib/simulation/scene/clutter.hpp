// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// Adds to an orchard of trees, trellis posts and bushes what `config.clutter` asks for. Moves
/// nothing that stands there, keeps off the robot's path; what moves comes last in the truth.
void add_clutter(std::uint64_t seed, const SimulationConfig& config, Scene& scene);

}  // namespace orchard::simulation
