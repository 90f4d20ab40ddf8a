// SPDX-License-Identifier: BSD-3-Clause
#include "bus/messages/codec.hpp"

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <utility>

#include "bus/messages/validity.hpp"
#include "bus/messages/wire_layout.hpp"
#include "bus/messages/wire_types.hpp"

namespace orchard::bus {
namespace {

/// Decodes bytes whose layout was checked; none when the generated decoder objects after all.
template <class Wire>
std::variant<Message, Rejection> decode_as(const void* data, std::size_t size) {
  try {
    Wire wire;
    const int decoded = wire.decode(data, 0, static_cast<int>(size));
    if (decoded != static_cast<int>(size)) {
      return Rejection{Reason::kUndecodable, "decoder read " + std::to_string(decoded) + " of " +
                                                 std::to_string(size) + " bytes"};
    }
    Message message = from_wire(std::move(wire));
    if (std::optional<Rejection> rejection = check_content(message)) return *std::move(rejection);
    return message;
  } catch (const std::exception& error) {
    return Rejection{Reason::kUndecodable, error.what()};
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
  return std::visit([](const auto& m) { return encode_wire(to_wire(m)); }, message);
}

std::variant<Message, Rejection> decode(Channel channel, const void* data, std::size_t size) {
  if (info(channel).role == Role::kService) {
    throw std::invalid_argument("decode: " + std::string(info(channel).name) +
                                " is a service channel");
  }
  if (std::optional<Rejection> rejection = check_layout(channel, data, size)) {
    return *std::move(rejection);
  }
  switch (channel) {
    case Channel::kScan:
      return decode_as<scan_t>(data, size);
    case Channel::kImage:
      return decode_as<image_t>(data, size);
    case Channel::kOdometry:
      return decode_as<odometry_t>(data, size);
    case Channel::kGnss:
      return decode_as<gnss_t>(data, size);
    case Channel::kPoseFix:
      return decode_as<pose_fix_t>(data, size);
    case Channel::kPose:
      return decode_as<pose_t>(data, size);
    case Channel::kDetections:
      return is_older_form(channel, data) ? decode_as<detections_t>(data, size)
                                          : decode_as<detections_v2_t>(data, size);
    case Channel::kMap:
      return decode_as<map_tile_t>(data, size);
    case Channel::kAdaptation:
      return decode_as<adaptation_t>(data, size);
    case Channel::kImu:
      return decode_as<imu_t>(data, size);
    case Channel::kTrajectory:
      return decode_as<trajectory_t>(data, size);
    default:
      throw std::invalid_argument("decode: no such channel");
  }
}

}  // namespace orchard::bus
