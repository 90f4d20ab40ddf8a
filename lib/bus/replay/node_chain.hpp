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

/// A source message on its way through the nodes, with all that followed from it so far.
struct ReplayEvent {
  ReplayEvent() = default;
  ReplayEvent(ReplayEvent&&) = default;
  ReplayEvent& operator=(ReplayEvent&&) = default;

  /// What a node sent.
  struct Derived {
    /// Who sent it, caused by which message: (node, how many of its outputs before it) from the
    /// source message on. Shorter ones come first, as on a bus that hands over in turn.
    std::vector<std::int32_t> way;
    Output output;
    std::optional<Message> message;  ///< where a later node reads its channel
  };

  std::optional<Message> source;                    ///< none: only a node's flush
  std::size_t flushed_node = 0;                     ///< of an event without source
  std::vector<std::unique_ptr<Foreseen>> foreseen;  ///< of each node
  std::deque<Derived> derived;  // what a node reads stays in place while it sends more
};

/// Nodes that read source messages and what earlier ones of them send. Each gets its inputs in the
/// order in which a bus would hand them over that is drained after every source message, whether
/// the nodes take an event one after the other or later events are at earlier nodes meanwhile.
class NodeChain {
 public:
  explicit NodeChain(const std::vector<Node*>& nodes);

  std::size_t size() const { return nodes_.size(); }
  bool is_read(Channel channel) const { return is_read_from(0, channel); }

  /// Asks every node what can be computed ahead of its turn. Events in order.
  void foresee(ReplayEvent& event) const;
  /// Computes that; several events at once may.
  static void compute_foreseen(ReplayEvent& event);
  /// One node takes what the event holds for it. Events in order, after the earlier nodes. Throws
  /// std::logic_error for a message that the guard refuses, or that an earlier node reads.
  void pass(std::size_t node, ReplayEvent& event);

 private:
  bool is_read_from(std::size_t node, Channel channel) const;
  void take_output(std::size_t node, Output&& output);

  std::vector<Node*> nodes_;
  std::vector<std::vector<bool>> reads_;  ///< node, channel
  /// Where a node's outputs go while it is in pass().
  struct Sink {
    ReplayEvent* event = nullptr;
    std::vector<std::int32_t> cause;  ///< the way of the message that it handles
    std::int32_t num_sent = 0;
  };
  std::vector<Sink> sinks_;
  std::vector<std::unique_ptr<NodeHost>> hosts_;
};

}  // namespace orchard::bus
