// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene/scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// Adds the objects of `config.clutter` to an orchard of trees, trellis posts and bushes. Moves no
/// existing object and keeps clear of the robot's path; moving objects are last in the truth.
void add_clutter(std::uint64_t seed, const SimulationConfig& config, Scene& scene);

}  // namespace orchard::simulation
