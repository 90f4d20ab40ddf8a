// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "detection/detection.hpp"
#include "mapping/pose_track.hpp"
#include "pose/pose_estimate.hpp"

namespace orchard::mapping {

/// When the last object of a scan was seen: its middle beam's utime [us]. The scan's own utime when
/// nothing in it says otherwise.
std::int64_t last_utime_of(const detection::Detections& detections);

/// The same objects as base would have them, had it stood at `T_map_base` (its pose at the scan's
/// utime) while the laser swept: each moved by base's motion between its own utime and the scan's.
///
/// At 1 m/s what a scanner of 75 ms sees straight ahead would otherwise stand 37 mm too near.
/// Objects around whose utime the track has no pose stay as they are. In the plane.
detection::Detections unswept(detection::Detections detections, const PoseTrack& track,
                              const pose::PoseEstimate& T_map_base);

}  // namespace orchard::mapping
