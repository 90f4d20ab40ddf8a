// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bus/replay/in_process_replay.hpp"

namespace orchard::bus {

/// Position of one source message in a log.
struct ReplayEntry {
  std::int64_t utime = 0;
  Channel channel = Channel::kScan;
  std::int32_t seq = 0;
  std::uint64_t offset = 0;  ///< as given by io::LogSeries
};

struct ReplayIndex {
  std::vector<ReplayEntry> entries;  ///< in order of (utime, channel, seq, offset)
  ReplayReport report;  ///< what was read, refused and missing; num_in and num_out are 0
};

/// Reads a log, or several logs of one drive, once and lists the source messages in replay order.
/// Throws io::FileError as replay_in_process does.
ReplayIndex index_log(const io::LogPaths& logs, const ReplayOptions& options);

}  // namespace orchard::bus
