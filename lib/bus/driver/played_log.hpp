// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bus/driver/driver.hpp"
#include "bus/messages/message.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::bus {

/// Plays the messages of some channels of a log at their times, relative to the log's first event.
/// Several programs can therefore play one log together.
class PlayedLog {
 public:
  /// `start_utime`: host time at which the log's first event is played [us]; 0: now. Throws
  /// io::FileError.
  PlayedLog(const std::string& log_path, std::int64_t start_utime, std::vector<Channel> channels);

  /// Returns the next message if its time has come, with its utime shifted to the host's time.
  /// Skips messages that fail the checks of decode().
  std::optional<Message> take_due();

  /// Time at which the next message is due; time_point::max() if there is none.
  Driver::Clock::time_point deadline() const;

 private:
  void find_next();

  io::LogReader log_;
  std::vector<Channel> channels_;
  std::int64_t shift_us_ = 0;
  std::optional<Message> next_;
};

}  // namespace orchard::bus
