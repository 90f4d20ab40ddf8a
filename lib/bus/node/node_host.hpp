// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "bus/node/node.hpp"
#include "bus/node/sequence_gate.hpp"
#include "bus/node/traffic_counts.hpp"

namespace orchard::bus {

/// One output of a node, encoded.
struct Output {
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::int64_t utime = 0;
  std::vector<std::uint8_t> bytes;
};

/// What surrounds a node wherever it runs (live process, lockstep process, in-process replay):
/// drops what came before, hands over the rest, encodes what it sends.
class NodeHost {
 public:
  using Publish = std::function<void(Output&&)>;

  NodeHost(Node& node, Publish publish);

  /// Live: hands the message over unless it is old, or keeps it aside until others agree with it
  /// (SequenceGate). Returns whether any was handed over.
  /// `arrival_us`: by the receiver's clock, for SequenceGate.
  bool receive(const Message& input, std::optional<std::int64_t> arrival_us = std::nullopt);

  /// Replay, whose player has already decided what is new: hands the message over.
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

  /// All but what the bus refused before it came here.
  TrafficCounts traffic() const;
  Node& node() { return node_; }

 private:
  Node& node_;
  Publish publish_;
  Outbox outbox_;
  SequenceGate gate_;
  std::array<std::vector<Message>, kNumChannels> held_;  ///< as the gate says
  TrafficCounts traffic_;                                ///< its num_in and num_out
};

}  // namespace orchard::bus
