// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/wire_format.hpp"

#include <array>
#include <string>

#include "orchard/ack_t.hpp"
#include "orchard/config_t.hpp"
#include "orchard/detections_t.hpp"
#include "orchard/detections_v2_t.hpp"
#include "orchard/gnss_t.hpp"
#include "orchard/image_t.hpp"
#include "orchard/imu_t.hpp"
#include "orchard/map_tile_t.hpp"
#include "orchard/map_ways_t.hpp"
#include "orchard/odometry_t.hpp"
#include "orchard/pose_fix_t.hpp"
#include "orchard/pose_t.hpp"
#include "orchard/replay_t.hpp"
#include "orchard/scan_t.hpp"
#include "orchard/status_t.hpp"
#include "orchard/trajectory_t.hpp"

namespace orchard::bus {
namespace {

struct WireFormat {
  std::int64_t type_hash;
  std::size_t max_bytes;
};

constexpr std::size_t kKiB = 1024;
constexpr std::size_t kMiB = 1024 * kKiB;

/// In the order of Channel.
const WireFormat& format_of(Channel channel) {
  static const std::array<WireFormat, kNumChannels> formats{{
      {scan_t::getHash(), kMiB},
      {image_t::getHash(), 16 * kMiB},
      {odometry_t::getHash(), kKiB},
      {gnss_t::getHash(), kKiB},
      {pose_fix_t::getHash(), kKiB},
      {pose_t::getHash(), kKiB},
      {detections_v2_t::getHash(), kMiB},
      {map_tile_t::getHash(), 16 * kMiB},
      {status_t::getHash(), 64 * kKiB},
      {config_t::getHash(), kMiB},
      {ack_t::getHash(), kMiB},
      {replay_t::getHash(), kKiB},
      {map_ways_t::getHash(), kMiB},
      {imu_t::getHash(), kKiB},
      {trajectory_t::getHash(), 64 * kKiB},
      {scan_t::getHash(), kMiB},
  }};
  return formats[static_cast<std::size_t>(channel)];
}

/// Big-endian, as in LCM.
std::int64_t read_hash(const void* data) {
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  std::uint64_t hash = 0;
  for (int i = 0; i < 8; ++i) hash = hash << 8 | bytes[i];
  return static_cast<std::int64_t>(hash);
}

Rejection too_short(std::size_t size, std::size_t min_bytes) {
  return {Reason::kTooShort,
          std::to_string(size) + " bytes, at least " + std::to_string(min_bytes)};
}

}  // namespace

std::int64_t type_hash(Channel channel) { return format_of(channel).type_hash; }

std::size_t max_bytes(Channel channel) { return format_of(channel).max_bytes; }

bool is_older_form(Channel channel, const void* data) {
  return channel == Channel::kDetections && read_hash(data) == detections_t::getHash();
}

std::optional<Rejection> check_head(Channel channel, const void* data, std::size_t size,
                                    std::size_t min_bytes) {
  // A datagram that is too short arrives with a size of 4 GB, so check the upper limit before any
  // access.
  if (size > max_bytes(channel)) {
    return Rejection{Reason::kTooLarge, std::to_string(size) + " bytes, at most " +
                                            std::to_string(max_bytes(channel))};
  }
  if (data == nullptr || size < sizeof(std::int64_t)) return too_short(size, min_bytes);
  if (read_hash(data) != type_hash(channel) && !is_older_form(channel, data)) {
    return Rejection{Reason::kWrongType, "not a " + std::string(info(channel).type)};
  }
  if (size < min_bytes) return too_short(size, min_bytes);
  return std::nullopt;
}

}  // namespace orchard::bus
