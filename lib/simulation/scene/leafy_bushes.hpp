// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Converts each bush of a scene from twigs to leaves, into which beams penetrate by `depth_m` on
/// average [m], sometimes through.
void make_bushes_leafy(double depth_m, Scene& scene);

}  // namespace orchard::simulation
