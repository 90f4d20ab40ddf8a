// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/node_host.hpp"
#include "bus/node/process_info.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"

namespace orchard::bus {

/// Number of a node in ack_t. Throws std::invalid_argument for an unknown name.
std::int8_t node_number(std::string_view name);

/// Runs a node in lockstep with orchard-log-player: it answers each input with its outputs and an
/// ACK. A repeated input (its ACK or an output was lost) gets the same outputs again without being
/// handled twice. A BEGIN after inputs creates a new node. STATUS is sent as usual, on the network
/// of the replay.
class LockstepNode {
 public:
  using MakeNode = std::function<std::unique_ptr<Node>()>;
  LockstepNode(Bus& bus, MakeNode make_node, SaveHook save, const std::string& name,
               const io::EffectiveConfig& config);

  /// Runs until a stop is requested. Throws BusError and whatever the node throws.
  void run(StopSignal& stop);

 private:
  using Key = std::pair<std::int64_t, std::int32_t>;  ///< utime, seq
  struct Reply {
    Ack ack;
    std::vector<Output> outputs;
  };
  /// Replies to the latest inputs of one channel.
  struct Answered {
    std::map<Key, Reply> replies;
    std::deque<Key> order;
  };

  void restart();
  void on_mark(const ReplayMark& mark);
  void on_input(const Message& input);
  bool comes_too_early(Channel channel, std::int32_t seq) const;
  void answer(Channel channel, Key key, const std::function<void()>& consume);
  void send(const Reply& reply);
  Status status() const;

  Bus& bus_;
  ProcessReport report_;
  MakeNode make_node_;
  SaveHook save_;
  std::unique_ptr<Node> node_;
  std::unique_ptr<NodeHost> host_;
  std::int8_t number_ = 0;
  bool fresh_ = true;
  std::vector<Output> outputs_;  ///< outputs of the input being handled
  std::array<Answered, kNumChannels> answered_;
  std::array<std::int32_t, kNumChannels> last_seq_{};
};

}  // namespace orchard::bus
