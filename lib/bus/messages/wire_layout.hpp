// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "bus/messages/channel.hpp"
#include "bus/messages/codec.hpp"

namespace orchard::bus {

/// Checks bytes against the layout of their channel's type before anything is decoded: size
/// limits, type hash, and every array count and string length against the bytes that follow.
/// After it has let bytes through, the generated decoder cannot allocate more than `size`.
std::optional<Rejection> check_layout(Channel channel, const void* data, std::size_t size);

/// Whether the bytes (at least 8) are of a form that an earlier release sent on that channel.
bool is_older_form(Channel channel, const void* data);

/// The smallest and largest message a channel carries [bytes].
std::size_t min_bytes(Channel channel);
std::size_t max_bytes(Channel channel);

}  // namespace orchard::bus
