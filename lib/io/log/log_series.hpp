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

/// The logs of one drive, in any order: one, or the pieces that lcm-logger split it into.
class LogPaths {
 public:
  LogPaths(std::string path) : paths_{std::move(path)} {}
  LogPaths(const char* path) : paths_{path} {}
  /// At least one.
  LogPaths(std::vector<std::string> paths) : paths_(std::move(paths)) {}

  const std::vector<std::string>& paths() const { return paths_; }

  /// For messages: "a.lcm", or "a.lcm and 2 more".
  std::string text() const;

  /// The names of the files without folders: "a.lcm, b.lcm".
  std::string names() const;

 private:
  std::vector<std::string> paths_;
};

/// Several logs read as one: their events in order of receipt, those of equal time in order of the
/// logs' beginnings, and of events that several logs hold only the first. What was split is read as
/// if it had not been.
class LogSeries {
 public:
  /// Throws io::FileError naming the path when a file cannot be opened.
  explicit LogSeries(const LogPaths& paths);

  /// The next event; its offset stands for its log, too: read_at() and where() know.
  std::optional<LogEvent> next();
  LogEvent read_at(std::uint64_t offset);

  /// "b.lcm at offset 1234" of an event's offset.
  std::string where(std::uint64_t offset) const;

  /// Of the logs read so far, each with offsets of its own.
  std::vector<LogGap> gaps() const;
  std::int64_t num_events() const { return num_events_; }
  /// Bytes consumed and bytes of all, for progress.
  std::uint64_t position() const { return position_; }
  std::uint64_t file_size() const { return file_size_; }

  /// Once all is read: stretches that no log covers, events that several hold, logs without any;
  /// one sentence each.
  std::vector<std::string> notes() const;

 private:
  struct Log {
    std::string path;
    std::optional<std::int64_t> first_timestamp_us;
    std::unique_ptr<LogReader> reader;  ///< open while it is read
    std::optional<LogEvent> head;
    std::vector<LogGap> gaps;
    std::int64_t num_repeated = 0;  ///< events that another log held before
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
  std::deque<std::pair<std::int64_t, std::uint64_t>> recent_;  ///< when and what came, lately
  std::unordered_map<std::uint64_t, const Log*> log_of_;       ///< of recent_
};

}  // namespace orchard::io
