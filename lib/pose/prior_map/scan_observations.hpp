// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "detection/detection.hpp"
#include "pose/field_of_view.hpp"
#include "pose/prior_map/prior_map_config.hpp"

namespace orchard::pose {

/// Returns the usable observations of a scan, corrected by the velocity of base from the time of
/// each to that of the scan. Values not finite, invalid covariances and objects beyond
/// observation_range_max_m are left out.
std::vector<ScanObservation> scan_observations(const detection::Detections& seen, double speed_mps,
                                               double yaw_rate_radps, const PriorMapConfig& config);

}  // namespace orchard::pose
