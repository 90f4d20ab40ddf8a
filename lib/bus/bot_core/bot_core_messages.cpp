// SPDX-License-Identifier: BSD-3-Clause
#include "bus/bot_core/bot_core_messages.hpp"

#include <cstdint>
#include <limits>
#include <utility>

#include "bot_core/gps_data_t.hpp"
#include "bot_core/image_t.hpp"
#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "bus/messages/field_check.hpp"
#include "bus/messages/field_reader.hpp"

namespace orchard::bus {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{32} << 20;  // an image of many megapixels
constexpr std::int32_t kAnyInt = std::numeric_limits<std::int32_t>::max();

// The fields in wire order; see bus/messages/fields.hpp. Limits are given where a bad value would
// reach a computation.

struct PlanarLidarFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.count("nranges", m.ranges);
    v.array("ranges", m.ranges, "nranges");
    v.count("nintensities", m.intensities);
    v.array("intensities", m.intensities, "nintensities");
    v.field("rad0", m.rad0, -100, 100);
    v.field("radstep", m.radstep, -10, 10);
  }
};

struct ImageMetadataFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.text("key", m.key);
    v.count("n", m.value);
    v.array("value", m.value, "n");
  }
};

struct BotImageFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("width", m.width, 1, 16384);
    v.field("height", m.height, 1, 16384);
    v.field("row_stride", m.row_stride, 0, 1 << 20);
    v.field("pixelformat", m.pixelformat, -kAnyInt - 1, kAnyInt);
    v.count("size", m.data);
    v.array("data", m.data, "size");
    v.count("nmetadata", m.metadata);
    v.items("metadata", m.metadata, "nmetadata", ImageMetadataFields{});
  }
};

struct BotPoseFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("pos", m.pos, -1e8, 1e8);
    v.field("vel", m.vel, -1e3, 1e3);
    v.field("orientation", m.orientation, -2, 2);
    v.field("rotation_rate", m.rotation_rate, -1e3, 1e3);
    v.field("accel", m.accel, -1e300, 1e300);
  }
};

struct BotGpsDataFields {
  template <class M, class Visitor>
  static void visit(M& m, Visitor& v) {
    v.time("utime", m.utime);
    v.field("gps_lock", m.gps_lock, -kAnyInt - 1, kAnyInt);
    v.field("longitude", m.longitude, -180, 180);
    v.field("latitude", m.latitude, -90, 90);
    v.field("elev", m.elev, -12000, 100000);
    v.field("horizontal_accuracy", m.horizontal_accuracy, -1e6, 1e6);
    v.field("vertical_accuracy", m.vertical_accuracy, -1e6, 1e6);
    v.field("numSatellites", m.num_satellites, -kAnyInt - 1, kAnyInt);
    v.field("speed", m.speed, -1e300, 1e300);
    v.field("heading", m.heading, -1e300, 1e300);
    v.field("xyz_pos", m.xyz_pos, -1e300, 1e300);
    v.field("gps_time", m.gps_time, -1e300, 1e300);
  }
};

template <class M, class Fields>
std::variant<NotBotCore, BotCoreMessage, Rejection> decode_as(const std::uint8_t* data,
                                                              std::size_t size) {
  if (size > kMaxBytes) return Rejection{Reason::kTooLarge, std::to_string(size) + " bytes"};
  M message;
  FieldReader reader(data, size, sizeof(std::int64_t));
  Fields::visit(message, reader);
  if (auto rejection = std::move(reader).result()) return *std::move(rejection);
  FieldCheck check;
  Fields::visit(std::as_const(message), check);
  if (auto rejection = std::move(check).result()) return *std::move(rejection);
  return BotCoreMessage(std::move(message));
}

}  // namespace

std::variant<NotBotCore, BotCoreMessage, Rejection> decode_bot_core(const void* data,
                                                                    std::size_t size) {
  if (data == nullptr || size < sizeof(std::int64_t)) return NotBotCore{};
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i) bits = bits << 8 | bytes[i];
  const auto hash = static_cast<std::int64_t>(bits);
  if (hash == bot_core::planar_lidar_t::getHash()) {
    return decode_as<BotPlanarLidar, PlanarLidarFields>(bytes, size);
  }
  if (hash == bot_core::image_t::getHash()) return decode_as<BotImage, BotImageFields>(bytes, size);
  if (hash == bot_core::pose_t::getHash()) return decode_as<BotPose, BotPoseFields>(bytes, size);
  if (hash == bot_core::gps_data_t::getHash()) {
    return decode_as<BotGpsData, BotGpsDataFields>(bytes, size);
  }
  return NotBotCore{};
}

const char* bot_core_type_name(const BotCoreMessage& message) {
  constexpr std::array<const char*, 4> kNames{"planar_lidar_t", "image_t", "pose_t", "gps_data_t"};
  return kNames.at(message.index());
}

}  // namespace orchard::bus
