// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "bus/bus.hpp"
#include "bus/node/stop_signal.hpp"
#include "bus/replay/in_process_replay.hpp"

namespace orchard::bus {

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
