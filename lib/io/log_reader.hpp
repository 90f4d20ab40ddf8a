// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "io/log_event.hpp"

namespace orchard::io {

/// A stretch of a log that could not be read.
struct LogGap {
  std::uint64_t offset = 0;  ///< of its first byte in the file
  std::uint64_t size = 0;    ///< bytes skipped
};

/// Reads the format of lcm-logger: bounded, and going on after damage.
///
/// An event whose header is implausible, or that ends beyond the file, is skipped up to the next
/// one that can be believed; each skip is a LogGap. Never reads more into memory than one event
/// of at most kMaxEventBytes.
class LogReader {
 public:
  static constexpr std::uint32_t kMaxChannelBytes = 63;
  static constexpr std::uint32_t kMaxEventBytes = 64u << 20;

  /// Throws io::FileError naming the path when the file cannot be opened.
  explicit LogReader(const std::string& path);

  /// The next event, or none at the end of the file.
  std::optional<LogEvent> next();

  /// The event at an offset that next() reported before. Throws FileError when it is not there.
  LogEvent read_at(std::uint64_t offset);

  const std::vector<LogGap>& gaps() const { return gaps_; }
  std::int64_t num_events() const { return num_events_; }
  std::uint64_t position() const { return position_; }   ///< bytes consumed, for progress
  std::uint64_t file_size() const { return file_size_; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
  std::ifstream file_;
  std::uint64_t file_size_ = 0;
  std::uint64_t position_ = 0;
  std::int64_t num_events_ = 0;
  std::vector<LogGap> gaps_;
};

}  // namespace orchard::io
