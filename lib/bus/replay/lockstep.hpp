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
#include "bus/replay/lockstep_protocol.hpp"

namespace orchard::bus {

/// Thrown when a node did not answer; the message names the node, the channel and the seq.
class LockstepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct LockstepOptions {
  ReplayOptions replay;
  std::vector<std::string> nodes{"detector", "pose", "mapper"};  ///< in the order of flushing
  int timeout_ms = 100;      ///< wait for an answer before a round is sent again
  int num_tries = 50;        ///< attempts without any progress before a node is given up
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

/// Replays a log through processes that run with --lockstep. Sends a round of source messages,
/// waits until every node has handled them and all messages derived from them have arrived, then
/// sends the next; what was lost is sent again. Outputs go to options.replay.on_derived in the same
/// order as with replay_in_process.
///
/// Messages of processes outside the replay are ignored. Throws LockstepError for a node that is
/// missing, does not answer or sends invalid messages, and io::FileError for the log.
LockstepReport replay_in_lockstep(const std::string& log_path, Bus& bus, StopSignal& stop,
                                  const LockstepOptions& options);

}  // namespace orchard::bus
