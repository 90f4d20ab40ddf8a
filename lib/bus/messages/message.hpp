// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <variant>

#include "bus/messages/channel.hpp"
#include "detection/adaptation/adaptation_step.hpp"
#include "detection/detection.hpp"
#include "laser/scan.hpp"
#include "mapping/landmark.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"
#include "pose/trajectory.hpp"
#include "vision/image.hpp"

namespace orchard::bus {

/// What a node reads and writes. The alternative decides the channel.
using Message =
    std::variant<laser::Scan, vision::Image, pose::Odometry, pose::Gnss, pose::PoseFix,
                 pose::PoseEstimate, detection::Detections, mapping::MapTile,
                 detection::AdaptationStep, pose::Imu, pose::TrajectoryPage, laser::RearScan>;

/// The channel of an alternative of Message: they stand in the order of Channel, the service
/// channels left out.
constexpr Channel channel_of_alternative(std::size_t index) {
  constexpr auto kFirstService = static_cast<std::size_t>(Channel::kStatus);
  constexpr auto kAfterService = static_cast<std::size_t>(Channel::kAdaptation);
  return static_cast<Channel>(index < kFirstService ? index
                                                    : index - kFirstService + kAfterService);
}

/// The channel a message travels on.
inline Channel channel_of(const Message& message) {
  return channel_of_alternative(message.index());
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
