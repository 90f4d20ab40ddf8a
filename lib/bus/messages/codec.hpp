// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/message.hpp"

namespace orchard::bus {

/// Why bytes from outside were refused; counted by reason.
enum class Reason : std::int8_t {
  kTooShort,      ///< smaller than the smallest message of its type
  kTooLarge,      ///< beyond the size limit of its channel
  kWrongType,     ///< another type's hash, or an old version of this one
  kBadCount,      ///< an array count that is negative or does not fit the bytes that follow
  kUndecodable,   ///< the generated decoder failed, threw, or left bytes over
  kNotFinite,     ///< NaN or infinity where a number is needed
  kOutOfRange,    ///< a value that cannot be (negative width, 400 degrees of latitude)
  kInconsistent,  ///< contradicts its own sizes (pixels, intensities)
};
inline constexpr std::size_t kNumReasons = 8;
std::string_view to_string(Reason reason);

struct Rejection {
  Reason reason = Reason::kUndecodable;
  std::string detail;  ///< one clause for a person: "num_ranges = -1"
};

/// The bytes of a message as LCM carries them.
std::vector<std::uint8_t> encode(const Message& message);

/// The guarded way from bytes to a message of a source or derived channel: size limits, type hash,
/// counts against remaining bytes before anything is allocated, decode, then semantic checks.
/// Never throws on account of the bytes. Throws std::invalid_argument for a service channel.
std::variant<Message, Rejection> decode(Channel channel, const void* data, std::size_t size);

}  // namespace orchard::bus
