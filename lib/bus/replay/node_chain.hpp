// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "bus/node/node.hpp"
#include "bus/node/node_host.hpp"

namespace orchard::bus {

/// A source message on its way through the nodes, with the messages derived from it so far.
struct ReplayEvent {
  ReplayEvent() = default;
  ReplayEvent(ReplayEvent&&) = default;
  ReplayEvent& operator=(ReplayEvent&&) = default;

  /// A message sent by a node.
  struct Derived {
    /// Chain of causes from the source message on: pairs of (node, index among its outputs).
    /// Shorter chains come first, as on a bus that delivers in turn.
    std::vector<std::int32_t> way;
    Output output;
    std::optional<Message> message;  ///< decoded, if a later node reads its channel
  };

  std::optional<Message> source;                             ///< none: the event is only a flush
  std::size_t flushed_node = 0;                              ///< for an event without source
  std::vector<std::unique_ptr<Precomputation>> precomputed;  ///< one per node
  std::deque<Derived> derived;  // a deque: appending does not move what a node is reading
};

/// A chain of nodes, each reading source messages and outputs of earlier nodes. Every node gets its
/// inputs in the order of a bus that is drained after each source message, even while earlier nodes
/// already process later events.
class NodeChain {
 public:
  explicit NodeChain(const std::vector<Node*>& nodes);

  std::size_t size() const { return nodes_.size(); }
  bool is_read(Channel channel) const { return is_read_from(0, channel); }

  /// Asks every node for work that can be computed in advance. Call for events in order.
  void precompute(ReplayEvent& event) const;
  /// Computes that work; may run for several events at once.
  static void compute_ahead(ReplayEvent& event);
  /// Passes the event's messages to one node. Call for events in order, after the earlier nodes.
  /// Throws std::logic_error for an output that is invalid, or that this or an earlier node reads.
  void pass(std::size_t node, ReplayEvent& event);

 private:
  bool is_read_from(std::size_t node, Channel channel) const;
  void take_output(std::size_t node, Output&& output);

  std::vector<Node*> nodes_;
  std::vector<std::vector<bool>> reads_;  ///< node, channel
  /// Receives a node's outputs while it is in pass().
  struct Sink {
    ReplayEvent* event = nullptr;
    std::vector<std::int32_t> cause;  ///< chain of causes of the message being handled
    std::int32_t num_sent = 0;
  };
  std::vector<Sink> sinks_;
  std::vector<std::unique_ptr<NodeHost>> hosts_;
};

}  // namespace orchard::bus
