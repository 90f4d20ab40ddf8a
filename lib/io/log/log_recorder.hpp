// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// How long a recording's files get and what they leave of the disk.
struct RecordingLimits {
  std::int64_t split_bytes = 500'000'000;         ///< a new file begins when one has this size
  std::int64_t keep_bytes = 0;                    ///< the oldest files go beyond this; 0: none goes
  std::int64_t least_free_bytes = 1'000'000'000;  ///< nothing is written when less would be free
};

/// Records messages as they come into logs of lcm-logger's format, STEM-000.lcm, STEM-001.lcm, ...
/// A file has its own name from its first event on and holds whole events only, so that what was
/// handed over more than about a second before the power fails can be read.
class LogRecorder {
 public:
  /// `stem`: path without number and ending; its folder is made. Throws FileError when a file of
  /// that stem is there already or none can be made.
  LogRecorder(std::string stem, RecordingLimits limits);
  ~LogRecorder();  ///< writes what is left
  LogRecorder(const LogRecorder&) = delete;
  LogRecorder& operator=(const LogRecorder&) = delete;

  /// Takes an event. One that cannot be written (no space, a name or size that no log may hold) is
  /// counted and left out.
  void write(std::int64_t utime, std::string_view channel, const std::uint8_t* data,
             std::size_t size);

  /// Hands everything to the system and asks it to put it on the disk, looks at the space that is
  /// left, begins new files and removes old ones. To be called about once a second.
  void sync();

  std::int64_t num_written() const { return num_written_; }
  std::int64_t num_dropped() const { return num_dropped_; }
  std::int64_t total_bytes() const;
  std::int64_t free_bytes() const { return free_bytes_; }
  const std::string& path() const { return path_; }  ///< of the file being written

  /// Why nothing is recorded, in words for a person; empty when all is well.
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
  std::int64_t file_bytes_ = 0;  ///< on the disk or on the way there
  std::int64_t num_in_file_ = 0;
  std::vector<std::uint8_t> buffer_;  ///< whole events that are not written yet
  std::int64_t num_in_buffer_ = 0;
  std::deque<Segment> finished_;
  std::int64_t num_written_ = 0;
  std::int64_t num_dropped_ = 0;
  std::int64_t free_bytes_ = 0;
  std::string problem_;
};

}  // namespace orchard::io
