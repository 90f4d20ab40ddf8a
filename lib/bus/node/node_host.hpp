// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "bus/node/node.hpp"
#include "bus/node/sequence_gate.hpp"

namespace orchard::bus {

/// One encoded output of a node.
struct Output {
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::int64_t utime = 0;
  std::vector<std::uint8_t> bytes;
};

/// Runs a node in any environment (live process, lockstep process, in-process replay): drops old
/// messages, passes the others to the node and encodes its outputs.
class NodeHost {
 public:
  using Publish = std::function<void(Output&&)>;

  NodeHost(Node& node, Publish publish);

  /// Live: passes the message to the node, drops it if it is old, or holds it until later messages
  /// confirm it (SequenceGate). Returns whether any message was passed to the node.
  /// `arrival_us`: time of arrival on the receiver's clock, for SequenceGate.
  bool receive(const Message& input, std::optional<std::int64_t> arrival_us = std::nullopt);

  /// Replay: passes the message to the node without checks, which the player has made.
  void deliver(const Message& input);

  void flush();

  SequenceCounts sequence_counts() const { return gate_.counts(); }
  const SequenceCounts& sequence_counts(Channel channel) const { return gate_.counts(channel); }
  std::int64_t num_handled() const;
  std::int64_t num_published() const;
  bool seen(Channel channel) const { return num_used(channel) > 0; }
  std::int64_t num_used(Channel channel) const {
    return traffic_.num_in[static_cast<std::size_t>(channel)];
  }

  /// Traffic counts of this host, without the messages that the bus rejected.
  TrafficCounts traffic() const;
  Node& node() { return node_; }

 private:
  Node& node_;
  Publish publish_;
  Outbox outbox_;
  SequenceGate gate_;
  std::array<std::vector<Message>, kNumChannels> held_;  ///< messages held back by the gate
  TrafficCounts traffic_;                                ///< only num_in and num_out are set
};

}  // namespace orchard::bus
