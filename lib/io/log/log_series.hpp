// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "io/log/log_reader.hpp"

namespace orchard::io {

/// Paths of the logs of one drive, in any order: a single log, or the pieces into which lcm-logger
/// split it.
class LogPaths {
 public:
  LogPaths(std::string path) : paths_{std::move(path)} {}
  LogPaths(const char* path) : paths_{path} {}
  /// Must not be empty.
  LogPaths(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  const std::vector<std::string>& paths() const { return paths_; }

  /// Text for messages: "a.lcm", or "a.lcm and 2 more".
  std::string text() const;

  /// File names without folders: "a.lcm, b.lcm".
  std::string names() const;

 private:
  std::vector<std::string> paths_;
};

/// Reads several logs as one. Events come in order of receipt; for equal times in order of the
/// logs' beginnings. An event that several logs contain is returned only once. A split log is read
/// as if it had not been split.
class LogSeries {
 public:
  /// Throws io::FileError naming the path when a file cannot be opened.
  explicit LogSeries(const LogPaths& paths);

  /// Returns the next event. Its offset also identifies the log; only read_at() and where() can
  /// interpret it.
  std::optional<LogEvent> next();
  LogEvent read_at(std::uint64_t offset);

  /// Describes the place of an offset: "b.lcm at offset 1234".
  std::string where(std::uint64_t offset) const;

  /// Gaps of the logs read so far, with offsets in the individual files.
  std::vector<LogGap> gaps() const;
  std::int64_t num_events() const { return num_events_; }
  /// Bytes read and total bytes, for progress.
  std::uint64_t position() const { return position_; }
  std::uint64_t file_size() const { return file_size_; }

  /// After the last event: describes times that no log covers, repeated events and logs without
  /// events, in one sentence each.
  std::vector<std::string> notes() const;

 private:
  struct Log {
    std::string path;
    std::optional<std::int64_t> first_timestamp_us;
    std::unique_ptr<LogReader> reader;  ///< open while it is being read
    std::optional<LogEvent> head;
    std::vector<LogGap> gaps;
    std::int64_t num_repeated = 0;  ///< events already read from another log
  };
  Log* earliest();
  void advance(Log& log);
  bool is_in_another(const Log& log, const LogEvent& event);

  std::vector<Log> logs_;  ///< in order of their beginnings
  std::size_t num_begun_ = 0;
  std::uint64_t file_size_ = 0;
  std::uint64_t position_ = 0;
  std::int64_t num_events_ = 0;
  std::optional<std::int64_t> last_timestamp_us_;
  std::vector<std::string> breaks_;
  std::deque<std::pair<std::int64_t, std::uint64_t>> recent_;  ///< time and hash of recent events
  std::unordered_map<std::uint64_t, const Log*> log_of_;       ///< first log of each recent event
};

}  // namespace orchard::io
