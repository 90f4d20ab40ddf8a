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

/// Messages of some channels of a log, each at its time: that of its utime after the log's first
/// event, so that several programs can play one log together.
class PlayedLog {
 public:
  /// `start_utime`: when the log's first event is played, by the host's clock [us]; 0: now. Throws
  /// io::FileError.
  PlayedLog(const std::string& log_path, std::int64_t start_utime, std::vector<Channel> channels);

  /// The next message if its time has come, its utime that of the host. What does not pass the
  /// guard is left out.
  std::optional<Message> take_due();

  /// When the next one is due; at the end of time where there is none.
  Driver::Clock::time_point deadline() const;

 private:
  void find_next();

  io::LogReader log_;
  std::vector<Channel> channels_;
  std::int64_t shift_us_ = 0;
  std::optional<Message> next_;
};

}  // namespace orchard::bus
