// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "io/log_reader.hpp"

namespace orchard::io {

/// What a log holds on one channel.
struct LogChannelSummary {
  std::int64_t num_events = 0;
  std::int64_t num_bytes = 0;         ///< of data
  std::int64_t first_timestamp_us = 0;
  std::int64_t last_timestamp_us = 0;
};

/// A log read from end to end, its messages not decoded.
struct LogSummary {
  std::map<std::string, LogChannelSummary> channels;
  std::int64_t num_events = 0;
  std::int64_t num_number_jumps = 0;  ///< places where the event number did not go up by one
  std::uint64_t file_size = 0;
  std::uint64_t num_lost_bytes = 0;   ///< in gaps
  std::vector<LogGap> gaps;
};

/// Reads the whole log. Throws FileError when it cannot be opened.
LogSummary summarize_log(const std::string& path);

/// Copies every event that can be read; they are numbered anew. Returns what was read. Throws
/// FileError when either file fails, when both are one, and when no event can be read.
LogSummary repair_log(const std::string& path, const std::string& out_path);

}  // namespace orchard::io
