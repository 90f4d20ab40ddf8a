// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/message.hpp"

namespace orchard::bus {

/// Reasons why received bytes are rejected; rejections are counted by reason.
enum class Reason : std::int8_t {
  kTooShort,      ///< smaller than the smallest message of its type
  kTooLarge,      ///< beyond the size limit of its channel
  kWrongType,     ///< type hash of another type, or of an unsupported version
  kBadCount,      ///< array count or string length that does not fit the remaining bytes
  kUndecodable,   ///< a bool that is neither 0 nor 1
  kNotFinite,     ///< NaN or infinity in a field that must be finite
  kOutOfRange,    ///< value outside its limits (negative width, latitude of 400 degrees)
  kInconsistent,  ///< fields contradict each other (number of pixels, of intensities)
};
inline constexpr std::size_t kNumReasons = 8;
std::string_view to_string(Reason reason);

struct Rejection {
  Reason reason = Reason::kUndecodable;
  std::string detail;  ///< one clause for the user: "num_ranges = -1"
};

/// Encodes a message as LCM bytes.
std::vector<std::uint8_t> encode(const Message& message);

/// Decodes and validates a message of a source or derived channel. Checks the size limits and the
/// type hash, then every array count against the remaining bytes before allocating, then the limits
/// and the consistency of the fields. Invalid bytes never throw. Throws std::invalid_argument for a
/// service channel.
std::variant<Message, Rejection> decode(Channel channel, const void* data, std::size_t size);

/// LCM type hash of a channel: the first eight bytes of each of its messages.
std::int64_t type_hash(Channel channel);

/// Checks the size and the type hash of received bytes. `min_bytes` is the encoded size with empty
/// arrays. Returns the reason for rejection, or none.
std::optional<Rejection> check_head(Channel channel, const void* data, std::size_t size,
                                    std::size_t min_bytes);

}  // namespace orchard::bus
