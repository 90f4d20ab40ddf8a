// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"

namespace orchard::bus {

// libbot's messages as on the wire, in their original units (lcmtypes/bot_core).

struct BotPlanarLidar {
  std::int64_t utime = 0;
  std::vector<float> ranges;
  std::vector<float> intensities;
  float rad0 = 0.0f;
  float radstep = 0.0f;
};

struct BotImageMetadata {
  std::string key;
  std::vector<std::uint8_t> value;
};

struct BotImage {
  std::int64_t utime = 0;
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t row_stride = 0;
  std::int32_t pixelformat = 0;
  std::vector<std::uint8_t> data;
  std::vector<BotImageMetadata> metadata;
};

struct BotPose {
  std::int64_t utime = 0;
  std::array<double, 3> pos{};
  std::array<double, 3> vel{};
  std::array<double, 4> orientation{};
  std::array<double, 3> rotation_rate{};
  std::array<double, 3> accel{};
};

struct BotGpsData {
  std::int64_t utime = 0;
  std::int32_t gps_lock = 0;
  double longitude = 0.0;
  double latitude = 0.0;
  double elev = 0.0;
  double horizontal_accuracy = 0.0;
  double vertical_accuracy = 0.0;
  std::int32_t num_satellites = 0;
  double speed = 0.0;
  double heading = 0.0;
  std::array<double, 3> xyz_pos{};
  double gps_time = 0.0;
};

using BotCoreMessage = std::variant<BotPlanarLidar, BotImage, BotPose, BotGpsData>;

/// The bytes are not one of these types.
struct NotBotCore {};

/// Decodes and validates a libbot message: checks the size, every array count against the remaining
/// bytes before allocating, and the limits of each field. Invalid bytes never throw.
std::variant<NotBotCore, BotCoreMessage, Rejection> decode_bot_core(const void* data,
                                                                    std::size_t size);

/// Type name of the message held: "planar_lidar_t".
const char* bot_core_type_name(const BotCoreMessage& message);

}  // namespace orchard::bus
