// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <variant>

#include "bus/channel.hpp"
#include "detection/adaptation_step.hpp"
#include "detection/detection.hpp"
#include "laser/scan.hpp"
#include "mapping/landmark.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"
#include "vision/image.hpp"

namespace orchard::bus {

/// What a node reads and writes. The alternative decides the channel.
using Message = std::variant<laser::Scan, vision::Image, pose::Odometry, pose::Gnss, pose::PoseFix,
                             pose::PoseEstimate, detection::Detections, mapping::MapTile,
                             detection::AdaptationStep>;

/// The channel a message travels on: the variant's alternatives stand in the order of Channel,
/// those that came after the service channels apart.
inline Channel channel_of(const Message& message) {
  if (std::holds_alternative<detection::AdaptationStep>(message)) return Channel::kAdaptation;
  return static_cast<Channel>(message.index());
}

/// Time of measurement of any message [us].
inline std::int64_t utime_of(const Message& message) {
  return std::visit([](const auto& m) { return m.utime; }, message);
}

/// Sequence number of any message.
inline std::int32_t seq_of(const Message& message) {
  return std::visit([](const auto& m) { return m.seq; }, message);
}

}  // namespace orchard::bus
