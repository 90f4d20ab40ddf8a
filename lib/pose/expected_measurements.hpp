// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pose/measurements.hpp"
#include "pose/pose_config.hpp"

namespace orchard::pose {

/// Returns which kinds of measurement the localiser uses, and how long to wait for each.
MeasurementWaits expected_measurements(const PoseConfig& config);

/// True if the motion of this mode is that of successive scans alone.
bool reads_scans(const PoseConfig& config);

/// Returns the configuration with which mode `fused` uses what this mode names, and nothing else.
PoseConfig as_fused(PoseConfig config);

}  // namespace orchard::pose
