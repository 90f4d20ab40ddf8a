// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Makes each bush of a scene leaves instead of twigs: one that beams go into by `depth_m` in the
/// mean [m], and here and there through.
void make_bushes_leafy(double depth_m, Scene& scene);

}  // namespace orchard::simulation
