// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>

#include "ros/ros_messages.hpp"
#include "vision/image.hpp"

namespace orchard::io {

/// Converts an image from a bag: JPEG is kept unchanged; uncompressed colour, PNG, YUV 4:2:2 and
/// Bayer patterns become BGR without loss, grey stays grey. seq is left 0. Returns NotUsed for
/// another encoding, or sizes that contradict the data.
std::variant<vision::Image, ros::NotUsed> bag_picture(const ros::Picture& picture);

}  // namespace orchard::io
