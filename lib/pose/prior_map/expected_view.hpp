// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "detection/detection.hpp"
#include "pose/prior_map/prior_map_config.hpp"
#include "pose/sight_field.hpp"

namespace orchard::pose {

/// The sightings of a scan that are of use, moved from the time at which each was made to that of
/// the scan by the velocity of base. What is not finite is left out.
std::vector<Sighting> sightings_at_scan(const detection::Detections& seen, double speed_mps,
                                        double yaw_rate_radps, const PriorMapConfig& config);

}  // namespace orchard::pose
