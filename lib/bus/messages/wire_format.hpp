// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"

namespace orchard::bus {

/// LCM type hash of a channel: the first eight bytes of each of its messages.
std::int64_t type_hash(Channel channel);

/// Maximum message size of a channel [bytes].
std::size_t max_bytes(Channel channel);

/// Whether the bytes (at least 8) have the type hash of an older version that is still readable.
bool is_older_form(Channel channel, const void* data);

/// Checks the size and the type hash of received bytes. `min_bytes` is the encoded size with empty
/// arrays. Returns the reason for rejection, or none.
std::optional<Rejection> check_head(Channel channel, const void* data, std::size_t size,
                                    std::size_t min_bytes);

}  // namespace orchard::bus
