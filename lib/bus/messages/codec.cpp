// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/codec.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "bus/messages/field_codec.hpp"
#include "bus/messages/service_messages.hpp"
#include "geometry/angles.hpp"
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

/// Whether the bytes (at least 8) have the type hash of an older version that is still readable.
bool is_older_form(Channel channel, const void* data) {
  return channel == Channel::kDetections && read_hash(data) == detections_t::getHash();
}

/// Maximum message size of a channel [bytes].
std::size_t max_bytes(Channel channel) { return format_of(channel).max_bytes; }

Rejection too_short(std::size_t size, std::size_t min_bytes) {
  return {Reason::kTooShort,
          std::to_string(size) + " bytes, at least " + std::to_string(min_bytes)};
}

struct JpegSize {
  int width_px = 0;
  int height_px = 0;
};

/// Reads the image size from a JPEG's frame header. None when the bytes are not a JPEG or end
/// before that header.
std::optional<JpegSize> find_jpeg_size(const std::vector<std::uint8_t>& data) {
  const std::size_t size = data.size();
  if (size < 4 || data[0] != 0xFF || data[1] != 0xD8) return std::nullopt;
  std::size_t i = 2;
  while (i + 4 <= size) {
    if (data[i] != 0xFF) return std::nullopt;
    const std::uint8_t marker = data[i + 1];
    if (marker == 0xFF) {  // fill byte
      ++i;
      continue;
    }
    const std::size_t length = std::size_t{data[i + 2]} << 8 | data[i + 3];
    // Frame headers are C0..CF apart from DHT (C4), JPG (C8) and DAC (CC).
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      if (length < 8 || i + 9 > size) return std::nullopt;
      JpegSize found;
      found.height_px = data[i + 5] << 8 | data[i + 6];
      found.width_px = data[i + 7] << 8 | data[i + 8];
      return found;
    }
    if (marker == 0xDA || marker == 0xD9 || length < 2) return std::nullopt;
    i += 2 + length;
  }
  return std::nullopt;
}

/// Default: a message has no consistency checks beyond its field limits.
template <class M>
void check(FieldCheck&, const M&) {}

void check(FieldCheck& c, const laser::Scan& scan) {
  c.require(scan.bearing_step_rad != 0.0, Reason::kOutOfRange, "bearing_step_rad = 0");
  c.require(scan.range_max_m > scan.range_min_m, Reason::kInconsistent,
            "range_max_m is not above range_min_m");
  c.require(!scan.ranges_m.empty(), Reason::kOutOfRange, "num_ranges = 0");
  if (!c.ok()) return;
  const double num_steps = static_cast<double>(scan.ranges_m.size()) - 1.0;
  c.require(num_steps * std::abs(scan.bearing_step_rad) <= 2 * geometry::kPi + 0.1,
            Reason::kInconsistent, "its beams cover more than a full turn");
  c.require(scan.intensities.empty() || scan.intensities.size() == scan.ranges_m.size(),
            Reason::kInconsistent, "num_intensities is neither 0 nor num_ranges");
  // ROS drivers send +inf for no return and NaN or -inf for a failed beam (REP 117); all readers of
  // ranges treat them as no return.
  int num_unusual = 0;  // counted without branches, several at a time
  for (const float range_m : scan.ranges_m) num_unusual += !((range_m >= 0) & (range_m <= 1e5f));
  if (num_unusual > 0) {
    for (const float range_m : scan.ranges_m) {
      if (std::isfinite(range_m)) c.field("ranges_m", range_m, 0, 1e5);
    }
  }
  for (const float intensity : scan.intensities) {
    c.require(std::isfinite(intensity), Reason::kNotFinite, "an intensity is not finite");
  }
}

void check(FieldCheck& c, const laser::RearScan& scan) {
  check(c, static_cast<const laser::Scan&>(scan));
}

void check(FieldCheck& c, const vision::Image& image) {
  const std::size_t num_pixels = static_cast<std::size_t>(image.width_px) * image.height_px;
  if (image.encoding == vision::Encoding::kBgr8) {
    c.require(image.data.size() == 3 * num_pixels, Reason::kInconsistent,
              "num_bytes is not 3 x width_px x height_px");
  } else if (image.encoding == vision::Encoding::kGray8) {
    c.require(image.data.size() == num_pixels, Reason::kInconsistent,
              "num_bytes is not width_px x height_px");
  } else {
    const std::optional<JpegSize> size = find_jpeg_size(image.data);
    c.require(size.has_value(), Reason::kInconsistent, "not a JPEG with a frame header");
    c.require(!size || (size->width_px == image.width_px && size->height_px == image.height_px),
              Reason::kInconsistent, "the JPEG's size is not width_px x height_px");
  }
}

void check(FieldCheck& c, const detection::Detections& detections) {
  for (const detection::Detection& trunk : detections.trunks) {
    // single precision: the sum may slightly exceed one
    c.field("probability_tree + probability_object",
            trunk.probability_tree + trunk.probability_object, 0, 1.0001);
    if (!c.ok()) return;
  }
}

void check(FieldCheck& c, const pose::TrajectoryPage& page) {
  // 64-bit, because num_pages of an invalid message may be INT32_MIN.
  c.field("page", page.page, 0, std::int64_t{page.num_pages} - 1);
}

void check(FieldCheck& c, const mapping::MapWays& ways) {
  c.field("part", ways.part, 0, std::int64_t{ways.num_parts} - 1);
  std::int64_t num_points = 0;
  for (const mapping::Way& way : ways.ways) num_points += way.num_points;
  c.require(num_points == static_cast<std::int64_t>(ways.points.size()), Reason::kInconsistent,
            "num_points is not the sum of the ways' points");
}

/// Checks that the fields of a message are consistent with each other and with its arrays. Expects
/// each field to be within its own limits. Returns the first violation, or none.
std::optional<Rejection> check_consistency(const Message& message) {
  FieldCheck c;
  std::visit([&c](const auto& m) { check(c, m); }, message);
  return std::move(c).result();
}

template <class M, class Fields>
std::variant<Message, Rejection> decode_as(Channel channel, const void* data, std::size_t size,
                                           Fields fields) {
  auto decoded = decode_fields<M>(channel, data, size, fields);
  if (auto* rejection = std::get_if<Rejection>(&decoded)) return std::move(*rejection);
  Message message = std::move(std::get<M>(decoded));
  if (auto rejection = check_consistency(message)) return *std::move(rejection);
  return message;
}

/// Finds the alternative of Message that belongs to the channel, starting at `kIndex`.
template <std::size_t kIndex = 0>
std::variant<Message, Rejection> decode_alternative(Channel channel, const void* data,
                                                    std::size_t size) {
  if constexpr (kIndex == std::variant_size_v<Message>) {
    throw std::invalid_argument("decode: unknown channel");
  } else {
    using M = std::variant_alternative_t<kIndex, Message>;
    if (channel != channel_of_alternative(kIndex)) {
      return decode_alternative<kIndex + 1>(channel, data, size);
    }
    return decode_as<M>(channel, data, size, fields_of(M{}));
  }
}

}  // namespace

std::string_view to_string(Reason reason) {
  switch (reason) {
    case Reason::kTooShort:
      return "too_short";
    case Reason::kTooLarge:
      return "too_large";
    case Reason::kWrongType:
      return "wrong_type";
    case Reason::kBadCount:
      return "bad_count";
    case Reason::kUndecodable:
      return "undecodable";
    case Reason::kNotFinite:
      return "not_finite";
    case Reason::kOutOfRange:
      return "out_of_range";
    case Reason::kInconsistent:
      return "inconsistent";
  }
  return "unknown";
}

std::vector<std::uint8_t> encode(const Message& message) {
  return std::visit([&](const auto& m) { return encode_fields(channel_of(message), m); }, message);
}

std::variant<Message, Rejection> decode(Channel channel, const void* data, std::size_t size) {
  if (info(channel).role == Role::kService) {
    throw std::invalid_argument("decode: " + std::string(info(channel).name) +
                                " is a service channel");
  }
  const bool has_hash =
      data != nullptr && size >= sizeof(std::int64_t) && size <= max_bytes(channel);
  if (has_hash && is_older_form(channel, data)) {
    return decode_as<detection::Detections>(channel, data, size,
                                            detection::DetectionsFields<true>{});
  }
  return decode_alternative(channel, data, size);
}

std::int64_t type_hash(Channel channel) { return format_of(channel).type_hash; }

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

std::vector<std::uint8_t> encode(const Status& status) {
  return encode_fields(Channel::kStatus, status);
}
std::vector<std::uint8_t> encode(const ConfigNotice& notice) {
  return encode_fields(Channel::kConfig, notice);
}
std::vector<std::uint8_t> encode(const Ack& ack) { return encode_fields(Channel::kAck, ack); }
std::vector<std::uint8_t> encode(const ReplayMark& mark) {
  return encode_fields(Channel::kReplay, mark);
}

std::variant<Status, Rejection> decode_status(const void* data, std::size_t size) {
  return decode_fields<Status>(Channel::kStatus, data, size, StatusFields{});
}
std::variant<ConfigNotice, Rejection> decode_config(const void* data, std::size_t size) {
  return decode_fields<ConfigNotice>(Channel::kConfig, data, size, ConfigNoticeFields{});
}
std::variant<Ack, Rejection> decode_ack(const void* data, std::size_t size) {
  return decode_fields<Ack>(Channel::kAck, data, size, AckFields{});
}
std::variant<ReplayMark, Rejection> decode_replay(const void* data, std::size_t size) {
  return decode_fields<ReplayMark>(Channel::kReplay, data, size, ReplayMarkFields{});
}

}  // namespace orchard::bus
