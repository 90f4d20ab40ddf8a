// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "mapping/landmark.hpp"
#include "pose/attitude/ground_profile.hpp"

namespace orchard::mapping {

/// Sets z_m and z_sd_m of each landmark: the height of the ground at the trunk, by the ground below
/// the robot nearby, which is a plane and, about it, a random walk as rough as it is there. Unknown
/// (z_sd_m = 0) where the standard deviation would be above a metre: where the robot was never
/// near, and for satellites without corrections, which tell no slope.
void set_heights(const pose::GroundProfile& ground, std::vector<Landmark>& landmarks);

}  // namespace orchard::mapping
