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

/// A node did not answer; the message says which, to which channel and seq.
class LockstepError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct LockstepOptions {
  ReplayOptions replay;
  std::vector<std::string> nodes{"detector", "pose", "mapper"};  ///< in the order of flushing
  int timeout_ms = 100;      ///< without an answer: the message is sent again
  int num_tries = 50;        ///< before the node is given up
  int start_timeout_s = 60;  ///< how long nodes may take to appear
  /// Words for people while waiting ("waits for orchard-pose").
  std::function<void(const std::string&)> say;
};

/// What a lockstep replay did besides what its ReplayReport says.
struct LockstepReport {
  ReplayReport replay;
  std::int64_t num_resent = 0;  ///< messages that had to be sent again
  double elapsed_s = 0.0;       ///< wall time from the first message to the last answer
  bool stopped = false;         ///< a signal ended it early
};

/// Replays a log through processes that run with --lockstep: sends a source message, waits until
/// every node has acknowledged it and everything that followed from it, and only then sends the
/// next. What is lost is sent again. Outputs go to options.replay.on_derived in the order in which
/// replay_in_process gives them.
///
/// Messages of strangers are left out. Throws LockstepError for a node that stays silent, is
/// missing or sends what the guard refuses, and io::FileError for the log.
LockstepReport replay_in_lockstep(const std::string& log_path, Bus& bus, StopSignal& stop,
                                  const LockstepOptions& options);

}  // namespace orchard::bus
