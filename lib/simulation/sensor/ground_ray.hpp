// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "simulation/scene/terrain.hpp"
#include "simulation/sensor/ray_fan.hpp"

namespace orchard::simulation {

/// What a beam returns from the ground or from grass on it, looked for up to `range_max_m`. The
/// grass is a layer of blades in which a beam gets a random (exponential) way far, `uniform` of (0,
/// 1] decides how far. `towards`: a unit vector; `from` and `towards` in map.
Hit meet_ground(const Terrain& terrain, double grass_height_m, const Eigen::Vector3d& from,
                const Eigen::Vector3d& towards, double range_max_m, double uniform);

}  // namespace orchard::simulation
