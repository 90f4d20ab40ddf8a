// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "bus/node/node.hpp"
#include "bus/node/traffic_counts.hpp"
#include "io/log/log_series.hpp"

namespace orchard::bus {

/// What a replay read, made and lost.
///
/// num_in counts source messages, num_out derived ones.
struct ReplayReport : TrafficCounts {
  std::int64_t num_events = 0;  ///< readable events of the log
  std::int64_t num_unknown_channel = 0;
  std::vector<io::LogGap> gaps;
  std::vector<std::string> warnings;  ///< one sentence each, for people
  std::int64_t first_utime = 0;       ///< of the sources
  std::int64_t last_utime = 0;
};

struct ReplayOptions {
  bool strict = false;  ///< any damage or rejection throws io::FileError instead of being counted
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
  /// Called at each event while the log is read through, before anything is replayed; what it
  /// throws ends the work.
  std::function<void()> check;
  /// Only messages from this to that many seconds after the log's first.
  double from_s = 0.0;
  double to_s = 1e18;
  /// Threads that work at once; 0: one for each core. What is made is the same.
  int num_jobs = 1;
  /// Every derived message, as the inputs caused them and for each input in order of (channel,
  /// seq); utime is the message's.
  std::function<void(Channel, std::int64_t utime, const std::vector<std::uint8_t>&)> on_derived;
};

/// Replays the source channels of a log, or of several of one drive, merged by (utime, channel,
/// seq), through nodes as on a bus that is drained after each input, then flushes them in order.
/// Deterministic. With more than one job the nodes stand on different inputs at a time, and the
/// callbacks come from other threads than the caller's, one at a time and in order. Throws
/// io::FileError for a log that cannot be read or holds no source channel.
ReplayReport replay_in_process(const io::LogPaths& logs, const std::vector<Node*>& nodes,
                               const ReplayOptions& options);

}  // namespace orchard::bus
