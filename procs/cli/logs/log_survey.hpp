// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bus/messages/codec.hpp"
#include "io/log/log_series.hpp"

namespace orchard::cli {

/// Content of one channel of a log.
struct ChannelSurvey {
  std::int64_t num_messages = 0;
  std::int64_t num_bytes = 0;
  std::int64_t num_refused = 0;     ///< rejected by the guard; known channels only
  std::int64_t num_duplicates = 0;  ///< this and the next three: counted by SequenceGate
  std::int64_t num_missing = 0;
  std::int64_t num_jumps = 0;                ///< single outliers in time or seq
  std::int64_t num_second_source_signs = 0;  ///< indications of a second source
  double clock_change_s = 0.0;               ///< last step of its clock
  std::int64_t first_utime = 0;              ///< of measurement; of receipt for unknown types
  std::int64_t last_utime = 0;
  std::array<std::int64_t, bus::kNumReasons> num_refused_by_reason{};
  std::string first_refusal;  ///< reason and detail of the first refused message
};

/// Content of a whole log.
struct LogSurvey {
  std::map<std::string, ChannelSurvey> channels;
  std::vector<io::LogGap> gaps;
  std::vector<std::string> notes;  ///< for several logs: gaps and overlaps between them
  std::int64_t num_events = 0;
  std::uint64_t file_size = 0;
  std::int64_t first_timestamp_us = 0;  ///< time of receipt
  std::int64_t last_timestamp_us = 0;

  std::int64_t num_refused() const;
  bool knows_a_channel() const;
  bool sound() const;  ///< all is readable, and some of it usable
};

/// Reads a whole log, or its parts as one log. Throws io::FileError when it cannot be opened or has
/// no events.
LogSurvey survey_log(const io::LogPaths& logs);

}  // namespace orchard::cli
