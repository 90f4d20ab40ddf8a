// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <variant>

#include "bus/messages/channel.hpp"
#include "detection/detection.hpp"
#include "laser/scan.hpp"
#include "mapping/finish/map_ways.hpp"
#include "mapping/landmark.hpp"
#include "pose/measurements.hpp"
#include "pose/pose_estimate.hpp"
#include "vision/image.hpp"

namespace orchard::bus {

/// A message that a node reads or writes. The type held determines the channel.
using Message = std::variant<laser::Scan, vision::Image, pose::Odometry, pose::Gnss, pose::PoseFix,
                             pose::PoseEstimate, detection::Detections, mapping::MapTile,
                             mapping::MapWays, pose::Imu, pose::TrajectoryPage, laser::RearScan>;

/// Channel of the alternative with this index in Message. The alternatives are in the order of
/// Channel, without the service channels.
constexpr Channel channel_of_alternative(std::size_t index) {
  constexpr auto kFirstService = static_cast<std::size_t>(Channel::kStatus);
  constexpr auto kAfterService = static_cast<std::size_t>(Channel::kMapWays);
  return static_cast<Channel>(index < kFirstService ? index
                                                    : index - kFirstService + kAfterService);
}

/// Channel on which a message is sent.
inline Channel channel_of(const Message& message) {
  return channel_of_alternative(message.index());
}

/// Time of measurement of any message [us].
inline std::int64_t utime_of(const Message& message) {
  return std::visit([](const auto& m) { return m.utime; }, message);
}

/// Gives a received message its drive time (timing/drive_time.hpp) and moves its other times along.
inline void set_drive_time(Message& message, std::int64_t drive_time) {
  const std::int64_t shift_us = drive_time - utime_of(message);
  std::visit([drive_time](auto& m) { m.utime = drive_time; }, message);
  if (auto* detections = std::get_if<detection::Detections>(&message)) {
    for (detection::Detection& d : detections->trunks) d.utime += shift_us;
    if (detections->image_utime != 0) detections->image_utime += shift_us;
  } else if (auto* page = std::get_if<pose::TrajectoryPage>(&message)) {
    for (pose::PoseEstimate& pose : page->poses) pose.utime += shift_us;
  }
}

/// Sequence number of any message.
inline std::int32_t seq_of(const Message& message) {
  return std::visit([](const auto& m) { return m.seq; }, message);
}

}  // namespace orchard::bus
