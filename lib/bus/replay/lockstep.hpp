// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/node.hpp"
#include "bus/node/process_options.hpp"
#include "bus/node/process_report.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/in_process_replay.hpp"

namespace orchard::bus {

/// Returns the URL for a lockstep replay on the given LCM network: the same address with the port
/// plus 10,000 (minus 10,000 where that exceeds the port range). A live system on the same port
/// would send the messages that the replay waits for, and they cannot be told apart. URLs other
/// than udpm:// are returned unchanged.
std::string lockstep_url(const std::string& lcm_url);

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

/// Thrown when a node did not answer; the message names the node, the channel and the seq.
class LockstepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct LockstepOptions {
  ReplayOptions replay;
  std::vector<std::string> nodes{"detector", "pose", "mapper"};  ///< in the order of flushing
  int timeout_ms = 100;      ///< wait for an answer before the message is sent again
  int num_tries = 50;        ///< attempts before the node is given up
  int start_timeout_s = 60;  ///< time for the nodes to appear
  /// Receives progress texts for the user while waiting ("waits for orchard-pose").
  std::function<void(const std::string&)> say;
};

/// Result of a lockstep replay.
struct LockstepReport {
  ReplayReport replay;
  std::int64_t num_resent = 0;  ///< messages that had to be sent again
  double elapsed_s = 0.0;       ///< wall time from the first message to the last answer
  bool stopped = false;         ///< ended early by a signal
};

/// Replays a log through processes that run with --lockstep. Sends one source message, waits until
/// every node has acknowledged it and all messages derived from it, then sends the next; lost
/// messages are sent again. Outputs go to options.replay.on_derived in the same order as with
/// replay_in_process.
///
/// Messages of processes outside the replay are ignored. Throws LockstepError for a node that is
/// missing, does not answer or sends invalid messages, and io::FileError for the log.
LockstepReport replay_in_lockstep(const std::string& log_path, Bus& bus, StopSignal& stop,
                                  const LockstepOptions& options);

}  // namespace orchard::bus
