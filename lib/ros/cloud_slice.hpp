// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "laser/scan.hpp"
#include "ros/ros_messages.hpp"

namespace orchard::ros {

/// The horizontal slice of a 3D scanner's cloud that is converted to a 2D scan, in the cloud's own
/// frame.
struct CloudSlice {
  double height_m = 0.0;     ///< height of its middle above the origin of the cloud's frame
  double thickness_m = 0.3;  ///< from its lower to its upper side
};

/// Converts a horizontal slice of a cloud to a scan: each beam is the nearest point of the slice at
/// its bearing.
///
/// The step between bearings is that of the scanner's longest line (field `ring`, or a row of an
/// ordered cloud). The bearings are aligned with the line that has the most points in the slice, so
/// that no beam between two points is empty. Where points have a time (`time` or `t` after the
/// stamp, `timestamp` absolute), beams are in order of time and utime is that of the first one. A
/// beam without a point in the slice is no return; a beam outside all points of the cloud is NaN.
/// NotUsed: no x, y and z, or fewer than 20 points of one line in the slice.
std::variant<laser::Scan, NotUsed> slice_cloud(const PointCloud& cloud, const CloudSlice& slice);

}  // namespace orchard::ros
