// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/node/node.hpp"
#include "io/log/log_series.hpp"

namespace orchard::bus {

/// Counts of a replay: num_in for source messages, num_out for derived ones, and losses.
struct ReplayReport : TrafficCounts {
  std::int64_t num_events = 0;  ///< readable events in the log
  std::int64_t num_unknown_channel = 0;
  std::vector<io::LogGap> gaps;
  std::vector<std::string> warnings;  ///< one sentence each, for the user
  std::int64_t first_utime = 0;       ///< of the source messages
  std::int64_t last_utime = 0;        ///< by the first clock, as if it had not been set back
};

struct ReplayOptions {
  bool strict = false;  ///< throw io::FileError for any damage or rejection instead of counting it
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  /// Called for each event of the first pass through the log, before the replay; an exception ends
  /// the work.
  std::function<void()> check;
  /// Time window to replay, relative to the log's first message [s].
  double from_s = 0.0;
  double to_s = 1e18;
  /// Number of threads; 0: one per core. The result does not depend on it.
  int num_jobs = 1;
  /// Receives every derived message, in the order of the inputs and for each input in order of
  /// (channel, seq); utime is that of the message.
  std::function<void(Channel, std::int64_t utime, const std::vector<std::uint8_t>&)> on_derived;
};

/// Replays the source channels of a log, or of several logs of one drive, through nodes. Messages
/// are merged by (drive time, channel, seq) and delivered as on a bus that is drained after each
/// input; at the end the nodes are flushed in order. The result is deterministic. With more than
/// one job the nodes process different inputs at the same time, and the callbacks are called from
/// other threads, one at a time and in order. Throws io::FileError for a log that cannot be read or
/// has no source channel.
ReplayReport replay_in_process(const io::LogPaths& logs, const std::vector<Node*>& nodes,
                               const ReplayOptions& options);

}  // namespace orchard::bus
