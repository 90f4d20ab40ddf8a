// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bus/replay/in_process_replay.hpp"
#include "bus/replay/replay_entries.hpp"

namespace orchard::bus {

struct ReplayIndex {
  ReplayEntries entries;  ///< in order of (utime, channel, seq, offset)
  ReplayReport report;    ///< what was read, refused and missing; num_in and num_out are 0
};

/// Reads a log, or several logs of one drive, once and lists the source messages in replay order.
/// Throws io::FileError as replay_in_process does.
ReplayIndex index_log(const io::LogPaths& logs, const ReplayOptions& options);

}  // namespace orchard::bus
