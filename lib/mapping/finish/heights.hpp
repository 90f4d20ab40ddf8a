// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"
#include "pose/attitude/ground_profile.hpp"

namespace orchard::mapping {

/// Sets z_m and z_sd_m of each landmark: the height of the ground at the trunk, by the plane that
/// fits best the ground below the robot nearby. Unknown (z_sd_m = 0) where the robot was never
/// near, and where the standard deviation would be above a metre: that of satellites without
/// corrections, which tells no slope.
void set_heights(const pose::GroundProfile& ground, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
