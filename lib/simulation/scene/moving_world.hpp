// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/scene/scene.hpp"
#include "simulation/scene/world_index.hpp"

namespace orchard::simulation {

/// Whether anything in the scene moves.
bool has_motion(const Scene& scene);

/// The scene's world at a time of the run [s]: people and vehicles where they are, what sways
/// where it is.
World world_at(const Scene& scene, double time_s);

/// The part of it that may reach into a circle, for lasers: no crowns, nothing of light.
World world_near(const Scene& scene, const WorldIndex& index, double x_m, double y_m,
                 double radius_m, double time_s);

/// The scene's truth at a time of the run [s]: people and vehicles where they are.
std::vector<TruthObject> truth_at(const Scene& scene, double time_s);

}  // namespace orchard::simulation
