// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bus/replay/in_process_replay.hpp"

namespace orchard::bus {

/// Where one source message stands in a log.
struct ReplayEntry {
  std::int64_t utime = 0;
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::uint64_t offset = 0;  ///< as io::LogSeries gives it
};

struct ReplayIndex {
  std::vector<ReplayEntry> entries;  ///< in order of (utime, channel, seq, offset)
  ReplayReport report;               ///< what was read, refused and missing; no messages in or out
};

/// Reads a log, or several of one drive, once: which source messages it holds, in the order in
/// which they are replayed. Throws io::FileError as replay_in_process does.
ReplayIndex index_log(const io::LogPaths& logs, const ReplayOptions& options);

}  // namespace orchard::bus
