// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/messages/message.hpp"
#include "bus/node/gated.hpp"
#include "bus/node/sequence_gate.hpp"
#include "text/finding.hpp"

namespace orchard::bus {

struct Status;

/// Receives a node's outputs in the order in which the node sends them.
using Outbox = std::function<void(Message)>;

/// Inputs that a node could not use. The host reports them in STATUS and summary.json.
struct NodeCounts {
  std::int64_t num_late = 0;      ///< arrived after the result they belong to was decided
  std::int64_t num_unusable = 0;  ///< well-formed but useless (an image that cannot be decoded)
};

/// How much a node depends on an input.
enum class InputNeed {
  kRequired,    ///< the node can do nothing without it and waits
  kOptional,    ///< the node works without it; a warning is given if it falls silent
  kOccasional,  ///< arrives rarely or never
};

/// Part of a node's work that can be computed in advance, on any thread, because it depends on no
/// output of other nodes.
class Precomputation {
 public:
  virtual ~Precomputation() = default;
  virtual void compute() = 0;
};

/// One processing role of the system (detector, pose, mapper). Its outputs are a pure function of
/// its configuration and the sequence of its inputs. The same object runs in the live process, in
/// the players and in tests. All times of inputs and outputs are drive times
/// (timing/drive_time.hpp).
class Node {
 public:
  virtual ~Node() = default;

  /// Short name: "detector", "pose", "mapper".
  virtual std::string_view name() const = 0;
  virtual std::vector<Channel> inputs() const = 0;

  /// Prepares the node, live only: called once, after the inputs are subscribed and before the
  /// first handle(). A node that takes long calls `on_progress` several times a second. Throws
  /// std::runtime_error when it cannot run.
  virtual void start(const std::function<void()>& /*on_progress*/) {}

  /// How much the node depends on one of its inputs().
  virtual InputNeed need_of(Channel channel) const {
    const bool occasional = channel == Channel::kTrajectory || channel == Channel::kPoseFix ||
                            channel == Channel::kMapWays;
    return occasional ? InputNeed::kOccasional : InputNeed::kRequired;
  }

  /// Handles one input and sends the resulting outputs. Within a channel seq increases (the host
  /// drops duplicates); between channels the order is arbitrary and must not matter.
  virtual void handle(const Message& input, const Outbox& send) = 0;

  /// Returns the part of handle(input) that can be computed in advance, or none; used by replays on
  /// several cores. Called for each input in order, by one thread at a time, possibly while another
  /// thread is in handle() of an earlier input. `input` outlives the returned object.
  virtual std::unique_ptr<Precomputation> precompute(const Message& /*input*/) { return nullptr; }

  /// Receives the computed result of precompute() for the next input of handle(). The outputs of
  /// handle() must not depend on whether this is called.
  virtual void use_precomputed(std::unique_ptr<Precomputation> /*precomputed*/) {}

  /// Drive times of the newest inputs that an earlier process has used; read after start().
  virtual std::map<Channel, std::int64_t> resumed() const { return {}; }

  /// Receives the STATUS of other processes, live only, for display. No output may depend on it.
  virtual void handle_status(const Status& /*status*/) {}

  /// Signals the end of the inputs: sends the outputs that were still waiting for one.
  virtual void flush(const Outbox& send) = 0;

  virtual NodeCounts counts() const { return {}; }

  /// Describes for the user what the node waits for ("SCAN at 12.3 s waits for an IMAGE"); empty if
  /// nothing.
  virtual std::string waiting_for() const { return {}; }

  /// Describes for the user what is wrong with the inputs (such as a rotated camera); empty if
  /// nothing. Shown in STATUS with level WARNING. After flush(): all problems seen during the run.
  virtual std::string warning() const { return {}; }

  /// What of the configuration the inputs contradict (such as the place of a sensor), beside
  /// warning() and shown like it. After flush(): by all inputs.
  virtual std::vector<Finding> findings() const { return {}; }
};

/// warning() and findings() of a node in one text; empty if nothing is wrong.
std::string warning_text(const Node& node);

/// Messages handled, published, rejected and lost, for a log or a live process.
struct TrafficCounts {
  std::array<std::int64_t, kNumChannels> num_in{};   ///< messages passed to nodes
  std::array<std::int64_t, kNumChannels> num_out{};  ///< messages sent by nodes
  std::array<std::int64_t, kNumReasons> num_rejected{};
  std::int64_t num_duplicates = 0;
  std::int64_t num_seq_gaps = 0;  ///< messages missing by seq
};

/// Lists the counts by name as written to summary.json: channels with messages, all rejection
/// reasons, and the unused inputs of each node. Names contain no spaces.
std::vector<std::pair<std::string, std::int64_t>> named_counts(
    const TrafficCounts& traffic, const std::vector<const Node*>& nodes);

/// One encoded output of a node.
struct Output {
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::int64_t utime = 0;
  std::vector<std::uint8_t> bytes;
  std::int64_t drive_time = 0;
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
  bool receive(Message input, std::optional<std::int64_t> arrival_us = std::nullopt);

  /// Lockstep: passes the message to the node without the checks that the player has made.
  void deliver_as_sent(Message input);

  /// Replay in one process: the same for a message that has its drive time.
  void deliver(const Message& input);

  /// Goes on after a message that an earlier process has used.
  void resume(Channel channel, std::int64_t drive_time) {
    gated_.gate().resume(channel, drive_time);
  }

  void flush();

  SequenceCounts sequence_counts() const { return gated_.gate().counts(); }
  const SequenceCounts& sequence_counts(Channel channel) const {
    return gated_.gate().counts(channel);
  }
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
  void deliver_at(std::int64_t drive_time, Message input);

  Node& node_;
  Publish publish_;
  Outbox outbox_;
  Gated<Message> gated_;
  TrafficCounts traffic_;  ///< only num_in and num_out are set
};

}  // namespace orchard::bus
