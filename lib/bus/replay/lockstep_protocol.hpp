// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bus/messages/channel.hpp"
#include "bus/messages/service_messages.hpp"

namespace orchard::bus {

/// Returns the URL for a lockstep replay on the given LCM network: the same address with the port
/// plus 10,000 (minus 10,000 where that exceeds the port range). A live system on the same port
/// would send the messages that the replay waits for, and they cannot be told apart. URLs other
/// than udpm:// are returned unchanged.
std::string lockstep_url(const std::string& lcm_url);

/// Number of a node in ack_t. Throws std::invalid_argument for an unknown name.
std::int8_t node_number(std::string_view name);
/// Number in ack_t of the node that sends a derived channel.
std::int8_t sender_of(Channel channel);

/// For each message of a round that a node has handled, or that it does not read: the messages that
/// the node sent because of it.
using LockstepSteps = std::vector<std::vector<OutputId>>;

/// Splits an ACK of a node into the steps that it reports. None if it is not about these messages
/// of the player.
std::optional<LockstepSteps> steps_of(const Ack& ack, const std::vector<OutputId>& round);

}  // namespace orchard::bus
