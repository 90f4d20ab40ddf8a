// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "simulation/scene.hpp"
#include "simulation/simulation_config.hpp"

namespace orchard::simulation {

/// An orchard: rows of trees along map y, unevenly spaced, some missing; posts and bushes in the
/// rows; a robot that starts at the origin, drives up and down every alley and turns in half
/// circles beyond the rows' ends.
Scene make_orchard_scene(std::uint64_t seed, const OrchardConfig& config);

}  // namespace orchard::simulation
