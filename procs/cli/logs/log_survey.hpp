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

/// What a log holds on one channel.
struct ChannelSurvey {
  std::int64_t num_messages = 0;
  std::int64_t num_bytes = 0;
  std::int64_t num_refused = 0;     ///< by the guard; only on channels that we know
  std::int64_t num_duplicates = 0;  ///< as SequenceGate counts these and the next
  std::int64_t num_missing = 0;
  std::int64_t num_leaps = 0;     ///< of another time or number than the rest, and alone
  std::int64_t num_contests = 0;  ///< signs of a second source
  double clock_change_s = 0.0;    ///< by how much its clock was set last
  std::int64_t first_utime = 0;   ///< of measurement; of receipt where we cannot decode
  std::int64_t last_utime = 0;
  std::array<std::int64_t, bus::kNumReasons> num_refused_by_reason{};
  std::string first_refusal;  ///< reason and detail of the first refused message
};

/// A log read from end to end.
struct LogSurvey {
  std::map<std::string, ChannelSurvey> channels;
  std::vector<io::LogGap> gaps;
  std::vector<std::string> notes;  ///< of several logs: what lies between them, what they share
  std::int64_t num_events = 0;
  std::uint64_t file_size = 0;
  std::int64_t first_timestamp_us = 0;  ///< of receipt
  std::int64_t last_timestamp_us = 0;

  std::int64_t num_refused() const;
  bool knows_a_channel() const;
  bool sound() const;  ///< all of it can be read, and something of it be used
};

/// Reads the whole log, or the pieces of one as one. Throws io::FileError when it cannot be opened
/// or is empty of events.
LogSurvey survey_log(const io::LogPaths& logs);

}  // namespace orchard::cli
