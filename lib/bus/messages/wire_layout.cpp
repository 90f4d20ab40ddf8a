// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/wire_layout.hpp"

#include <array>
#include <cstring>
#include <string>

#include "orchard/ack_t.hpp"
#include "orchard/adaptation_t.hpp"
#include "orchard/config_t.hpp"
#include "orchard/detections_t.hpp"
#include "orchard/detections_v2_t.hpp"
#include "orchard/gnss_t.hpp"
#include "orchard/image_t.hpp"
#include "orchard/imu_t.hpp"
#include "orchard/map_tile_t.hpp"
#include "orchard/odometry_t.hpp"
#include "orchard/pose_fix_t.hpp"
#include "orchard/pose_t.hpp"
#include "orchard/replay_t.hpp"
#include "orchard/scan_t.hpp"
#include "orchard/status_t.hpp"
#include "orchard/trajectory_t.hpp"

namespace orchard::bus {
namespace {

/// An array whose int32 count stands at a fixed offset; element_bytes 0 = no such array.
struct ArrayLayout {
  std::size_t count_offset = 0;
  std::size_t element_bytes = 0;
  const char* count_name = "";
};

/// How a type lies on the wire, hash included: `head_bytes` of fixed fields, then the arrays, then
/// `num_strings` strings. The unit test compares these figures with the generated encoders.
struct Layout {
  std::int64_t (*hash)();
  std::size_t head_bytes;
  std::size_t max_bytes;
  std::array<ArrayLayout, 2> arrays;
  int num_strings;
};

constexpr std::size_t kKiB = 1024;
constexpr std::size_t kMiB = 1024 * kKiB;

template <class Type>
std::int64_t hash_of() {
  return Type::getHash();
}

const Layout& layout_of(Channel channel) {
  static const std::array<Layout, kNumChannels> layouts{{
      {hash_of<scan_t>, 68, kMiB, {{{20, 4, "num_ranges"}, {24, 4, "num_intensities"}}}, 0},
      {hash_of<image_t>, 33, 16 * kMiB, {{{20, 1, "num_bytes"}, {}}}, 0},
      {hash_of<odometry_t>, 60, kKiB, {}, 0},
      {hash_of<gnss_t>, 93, kKiB, {}, 0},
      {hash_of<pose_fix_t>, 93, kKiB, {}, 0},
      {hash_of<pose_t>, 108, kKiB, {}, 0},
      {hash_of<detections_v2_t>, 32, kMiB, {{{20, 146, "num_trunks"}, {}}}, 0},
      {hash_of<map_tile_t>,
       32,
       16 * kMiB,
       {{{20, 97, "num_landmarks"}, {24, 4, "num_removed"}}},
       0},
      {hash_of<status_t>, 93, 64 * kKiB, {}, 3},
      {hash_of<config_t>, 28, kMiB, {}, 3},
      {hash_of<ack_t>, 26, kMiB, {{{20, 5, "num_outputs"}, {}}}, 0},
      {hash_of<replay_t>, 21, kKiB, {}, 0},
      {hash_of<adaptation_t>, 70, kKiB, {}, 0},
      {hash_of<imu_t>, 117, kKiB, {}, 0},
      {hash_of<trajectory_t>, 36, 64 * kKiB, {{{20, 80, "num_poses"}, {}}}, 0},
  }};
  return layouts[static_cast<std::size_t>(channel)];
}

/// Forms of earlier releases that are still read.
const Layout* older_layout_of(Channel channel) {
  static const Layout detections{
      hash_of<detections_t>, 32, kMiB, {{{20, 134, "num_trunks"}, {}}}, 0};
  return channel == Channel::kDetections ? &detections : nullptr;
}

/// Big-endian, as LCM writes it.
std::uint32_t read_u32(const std::uint8_t* p) {
  return std::uint32_t{p[0]} << 24 | std::uint32_t{p[1]} << 16 | std::uint32_t{p[2]} << 8 | p[3];
}

std::uint64_t read_u64(const std::uint8_t* p) {
  return std::uint64_t{read_u32(p)} << 32 | read_u32(p + 4);
}

}  // namespace

std::size_t min_bytes(Channel channel) {
  const Layout& layout = layout_of(channel);
  return layout.head_bytes + 5 * static_cast<std::size_t>(layout.num_strings);
}

std::size_t max_bytes(Channel channel) { return layout_of(channel).max_bytes; }

bool is_older_form(Channel channel, const void* data) {
  const Layout* older = older_layout_of(channel);
  return older != nullptr && read_u64(static_cast<const std::uint8_t*>(data)) ==
                                 static_cast<std::uint64_t>(older->hash());
}

std::optional<Rejection> check_layout(Channel channel, const void* data, std::size_t size) {
  // A runt datagram arrives with a size of 4 GB, so the upper limit comes before any access.
  if (size > max_bytes(channel)) {
    return Rejection{Reason::kTooLarge, std::to_string(size) + " bytes, at most " +
                                            std::to_string(max_bytes(channel))};
  }
  if (data == nullptr || size < 8) {
    return Rejection{Reason::kTooShort, std::to_string(size) + " bytes, at least " +
                                            std::to_string(min_bytes(channel))};
  }
  const auto* bytes = static_cast<const std::uint8_t*>(data);
  const Layout& layout =
      is_older_form(channel, data) ? *older_layout_of(channel) : layout_of(channel);
  if (read_u64(bytes) != static_cast<std::uint64_t>(layout.hash())) {
    return Rejection{Reason::kWrongType, "not a " + std::string(info(channel).type)};
  }
  if (size < min_bytes(channel)) {
    return Rejection{Reason::kTooShort, std::to_string(size) + " bytes, at least " +
                                            std::to_string(min_bytes(channel))};
  }
  std::size_t position = layout.head_bytes;
  for (const ArrayLayout& array : layout.arrays) {
    if (array.element_bytes == 0) continue;
    const std::uint32_t count = read_u32(bytes + array.count_offset);
    if (count > (size - position) / array.element_bytes) {
      return Rejection{
          Reason::kBadCount,
          array.count_name + (" = " + std::to_string(static_cast<std::int32_t>(count)))};
    }
    position += count * array.element_bytes;
  }
  for (int i = 0; i < layout.num_strings; ++i) {
    if (size - position < 5) return Rejection{Reason::kTooShort, "ends before its strings"};
    // The length counts the closing zero; the generated decoder subtracts one unchecked.
    const std::uint32_t length = read_u32(bytes + position);
    position += 4;
    // Exactly one zero, at its end: LCM's encoder would cut at an earlier one.
    if (length < 1 || length > size - position ||
        std::memchr(bytes + position, 0, length) != bytes + position + length - 1) {
      return Rejection{Reason::kBadCount, "a string of " + std::to_string(length) + " bytes"};
    }
    position += length;
  }
  if (position != size) {
    return Rejection{Reason::kBadCount, "its counts make " + std::to_string(position) +
                                            " bytes of " + std::to_string(size)};
  }
  return std::nullopt;
}

}  // namespace orchard::bus
