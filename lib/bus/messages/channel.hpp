// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace orchard::bus {

/// Every channel of the system. The order decides between messages of equal utime, and the numbers
/// are sent in ack_t: append new channels, never reorder.
enum class Channel : std::int8_t {
  kScan = 0,
  kImage = 1,
  kOdometry = 2,
  kGnss = 3,
  kPoseFix = 4,
  kPose = 5,
  kDetections = 6,
  kMap = 7,
  kStatus = 8,
  kConfig = 9,
  kAck = 10,
  kReplay = 11,
  kMapWays = 12,
  kImu = 13,
  kTrajectory = 14,
  kScanRear = 15,
};

inline constexpr std::size_t kNumChannels = 16;

/// Purpose of a channel, which decides how a replay treats it.
enum class Role {
  kSource,   ///< published by sensor drivers: recorded and replayed
  kDerived,  ///< computed from the sources: recorded and compared, never replayed
  kService,  ///< about processes: never replayed, never compared
};

struct ChannelInfo {
  Channel channel;
  std::string_view name;  ///< on the wire
  std::string_view type;  ///< LCM type that is published, without the package
  Role role;
};

/// Table of all channels with their names, types and roles.
inline constexpr std::array<ChannelInfo, kNumChannels> kChannels{{
    {Channel::kScan, "SCAN", "scan_t", Role::kSource},
    {Channel::kImage, "IMAGE", "image_t", Role::kSource},
    {Channel::kOdometry, "ODOMETRY", "odometry_t", Role::kSource},
    {Channel::kGnss, "GNSS", "gnss_t", Role::kSource},
    {Channel::kPoseFix, "POSE_FIX", "pose_fix_t", Role::kSource},
    {Channel::kPose, "POSE", "pose_t", Role::kDerived},
    {Channel::kDetections, "DETECTIONS", "detections_v2_t", Role::kDerived},
    {Channel::kMap, "MAP", "map_tile_t", Role::kDerived},
    {Channel::kStatus, "STATUS", "status_t", Role::kService},
    {Channel::kConfig, "CONFIG", "config_t", Role::kService},
    {Channel::kAck, "ACK", "ack_t", Role::kService},
    {Channel::kReplay, "REPLAY", "replay_t", Role::kService},
    {Channel::kMapWays, "MAP_WAYS", "map_ways_t", Role::kDerived},
    {Channel::kImu, "IMU", "imu_t", Role::kSource},
    {Channel::kTrajectory, "TRAJECTORY", "trajectory_t", Role::kDerived},
    {Channel::kScanRear, "SCAN.rear", "scan_t", Role::kSource},
}};

constexpr const ChannelInfo& info(Channel channel) {
  return kChannels[static_cast<std::size_t>(channel)];
}

/// Finds a channel by its name on the wire.
constexpr std::optional<Channel> find_channel(std::string_view name) {
  for (const ChannelInfo& entry : kChannels) {
    if (entry.name == name) return entry.channel;
  }
  return std::nullopt;
}

}  // namespace orchard::bus
