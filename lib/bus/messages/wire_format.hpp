// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"

namespace orchard::bus {

/// LCM's hash of the type that a channel carries: the first eight bytes of each message.
std::int64_t type_hash(Channel channel);

/// The largest message a channel carries [bytes].
std::size_t max_bytes(Channel channel);

/// Whether the bytes (at least 8) are of a form that an earlier release sent on that channel.
bool is_older_form(Channel channel, const void* data);

/// Why bytes cannot be a message of that channel, by their size and type hash alone; `min_bytes`
/// is the size of one whose arrays are empty.
std::optional<Rejection> check_head(Channel channel, const void* data, std::size_t size,
                                    std::size_t min_bytes);

}  // namespace orchard::bus
