// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "laser/scan.hpp"
#include "ros/ros_messages.hpp"

namespace orchard::ros {

/// The slice of a 3D scanner's cloud that stands for a 2D scan, in the cloud's own frame.
struct CloudSlice {
  double height_m = 0.0;     ///< of its middle above the origin of the cloud's frame
  double thickness_m = 0.3;  ///< from its lower to its upper side
};

/// A horizontal slice of a cloud as a scan: at each bearing the nearest point of the slice.
///
/// The step between bearings is that of the scanner's longest line (field `ring`, a row of an
/// ordered cloud), and the bearings fall onto those of the line with most points in the slice, so
/// that no beam stays empty between two points. Where points carry their time (`time` or `t` behind
/// the stamp, `timestamp` absolute), beams come in its order and utime is the first one's. A beam
/// without a point in the slice is no return; one outside of all points of the cloud is NaN.
/// NotUsed: no x, y and z, or fewer than 20 points of one line in the slice.
std::variant<laser::Scan, NotUsed> slice_cloud(const PointCloud& cloud, const CloudSlice& slice);

}  // namespace orchard::ros
