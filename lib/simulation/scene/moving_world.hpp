// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/scene/scene.hpp"
#include "simulation/scene/world_index.hpp"

namespace orchard::simulation {

/// True if anything in the scene moves.
bool has_motion(const Scene& scene);

/// The scene's world at a time of the run [s], with people, vehicles and swaying objects at their
/// current positions.
World world_at(const Scene& scene, double time_s);

/// The part of the world that may reach into a circle, for lasers: without crowns and light.
World world_near(const Scene& scene, const WorldIndex& index, double x_m, double y_m,
                 double radius_m, double time_s);

/// The scene's truth at a time of the run [s], with people and vehicles at their current positions.
std::vector<TruthObject> truth_at(const Scene& scene, double time_s);

}  // namespace orchard::simulation
