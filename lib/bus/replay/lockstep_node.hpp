// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/node.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/lockstep_protocol.hpp"

namespace orchard::bus {

/// Runs a node in lockstep with orchard-log-player: it handles the messages of a round, and what
/// the other nodes sent because of them, in the order of a replay in one process; then it answers
/// with an ACK and its outputs. Asked again (something was lost), it sends them again and handles
/// nothing twice. A BEGIN after a round creates a new node. STATUS is sent as usual, on the network
/// of the replay.
class LockstepNode {
 public:
  using MakeNode = std::function<std::unique_ptr<Node>()>;
  LockstepNode(Bus& bus, MakeNode make_node, SaveHook save, const std::string& name,
               const io::EffectiveConfig& config);

  /// Runs until a stop is requested. Throws BusError and whatever the node throws.
  void run(StopSignal& stop);

 private:
  struct Round {
    std::vector<OutputId> steps;  ///< the player's messages, in order
    /// Nodes whose outputs are read here: what they sent at each step; empty until their ACK.
    std::map<std::int8_t, LockstepSteps> senders;
    std::map<OutputId, std::optional<Message>> inputs;  ///< announced; none until received
    std::map<OutputId, std::int64_t> utimes;            ///< of those received
    std::size_t num_made = 0;                           ///< steps
    Ack ack;                                            ///< its seq is the round's number
    std::vector<Output> outputs;
  };

  void restart();
  void on_mark(const ReplayMark& mark);
  void on_ack(const Ack& ack);
  void start_round(const Ack& plan);
  bool reads(const OutputId& id) const;
  void expect(const OutputId& id);
  void receive(const OutputId& id, Message&& message);
  std::vector<OutputId> inputs_of(std::size_t step) const;
  bool is_ready() const;
  void make_step();
  void finish();
  void answer();
  Status status() const;

  Bus& bus_;
  ProcessReport report_;
  MakeNode make_node_;
  SaveHook save_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<NodeHost> host_;
  std::int8_t number_ = 0;
  std::int64_t replay_utime_ = -1;  ///< of the BEGIN
  Round round_;
  bool asked_again_ = false;
  std::string
      stranger_;  ///< what another program published into the replay; it is not answered then
};

}  // namespace orchard::bus
