// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// Limits on the size of a recording's files and on the disk space they use.
struct RecordingLimits {
  std::int64_t split_bytes = 500'000'000;  ///< size at which a new file begins
  std::int64_t keep_bytes = 0;  ///< the oldest files are deleted beyond this total; 0: never
  std::int64_t least_free_bytes = 1'000'000'000;  ///< free space below which writing stops
};

/// Records messages into logs of lcm-logger's format, STEM-000.lcm, STEM-001.lcm, ... A file has
/// its final name from its first event on and contains only complete events, so that after a power
/// failure everything written more than about a second before can be read.
class LogRecorder {
 public:
  /// `stem`: path without number and extension; its folder is created. Throws FileError when a file
  /// of that stem exists or none can be created.
  LogRecorder(std::string stem, RecordingLimits limits);
  ~LogRecorder();  ///< writes the remaining events
  LogRecorder(const LogRecorder&) = delete;
  LogRecorder& operator=(const LogRecorder&) = delete;

  /// Adds an event. One that cannot be written (no space, invalid channel name or size) is counted
  /// and dropped.
  void write(std::int64_t utime, std::string_view channel, const std::uint8_t* data,
             std::size_t size);

  /// Writes all buffered events, asks the system to sync them, checks the free space, begins new
  /// files and deletes old ones. Call it about once a second.
  void sync();

  std::int64_t num_written() const { return num_written_; }
  std::int64_t num_dropped() const { return num_dropped_; }
  std::int64_t total_bytes() const;
  std::int64_t free_bytes() const { return free_bytes_; }
  const std::string& path() const { return path_; }  ///< file being written

  /// Why nothing is recorded, for the user; empty when all is well.
  const std::string& problem() const { return problem_; }

 private:
  struct Segment {
    std::string path;
    std::int64_t bytes = 0;
  };

  bool open_next();
  void flush();
  void close_file();
  void remove_oldest();
  void look_at_space();
  bool is_space_short() const;

  std::string stem_;
  RecordingLimits limits_;
  std::string path_;
  int fileno_ = -1;
  int next_number_ = 0;
  std::int64_t file_bytes_ = 0;  ///< handed to the system, without buffer_
  std::int64_t num_in_file_ = 0;
  std::vector<std::uint8_t> buffer_;  ///< complete events not written yet
  std::int64_t num_in_buffer_ = 0;
  std::deque<Segment> finished_;
  std::int64_t num_written_ = 0;
  std::int64_t num_dropped_ = 0;
  std::int64_t free_bytes_ = 0;
  std::string problem_;
};

}  // namespace orchard::io
