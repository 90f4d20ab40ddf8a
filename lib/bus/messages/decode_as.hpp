// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "bus/messages/codec.hpp"

namespace orchard::bus {

/// The message, if the bytes are a valid one of that kind.
template <class Kind>
std::optional<Kind> decode_as(Channel channel, const std::vector<std::uint8_t>& bytes) {
  auto decoded = decode(channel, bytes.data(), bytes.size());
  auto* message = std::get_if<Message>(&decoded);
  auto* kind = message ? std::get_if<Kind>(message) : nullptr;
  return kind ? std::optional<Kind>(std::move(*kind)) : std::nullopt;
}

}  // namespace orchard::bus
