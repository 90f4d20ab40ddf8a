// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "ros/ros_messages.hpp"
#include "vision/image.hpp"

namespace orchard::io {

/// A picture of a bag as one of ours: JPEG as it is; uncompressed colours, PNG, YUV 4:2:2 and Bayer
/// patterns as BGR without loss, grey as grey. seq is left 0. NotUsed: another encoding, or sizes
/// that contradict the data.
std::variant<vision::Image, ros::NotUsed> bag_picture(const ros::Picture& picture);

}  // namespace orchard::io
