// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <istream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/log/file_window.hpp"
#include "io/log/log_format.hpp"

namespace orchard::io {

/// A part of a log that could not be read.
struct LogGap {
  std::uint64_t offset = 0;  ///< of its first byte in the file
  std::uint64_t size = 0;    ///< bytes skipped
  std::string log;           ///< path of the file
};

/// Reads lcm-logger's format with bounded memory and recovers after damage.
///
/// An event is skipped if its header is implausible, if it contains the start of another event, or
/// if it ends beyond the file; reading continues at the next plausible event, and each skip is a
/// LogGap. At most one event of kMaxEventBytes is in memory. Damage to the data of an event cannot
/// be detected here, nor a length that is too short (its rest becomes a gap), so the decoder must
/// check the data.
class LogReader {
 public:
  static constexpr std::uint32_t kMaxChannelBytes = LogEventHeader::kMaxChannelBytes;
  static constexpr std::uint32_t kMaxEventBytes = LogEventHeader::kMaxEventBytes;

  /// Throws io::FileError naming the path when the file cannot be opened.
  explicit LogReader(const std::string& path);

  /// Reads from a seekable stream; `name` replaces the path in messages.
  LogReader(std::unique_ptr<std::istream> stream, const std::string& name);

  /// The next event, or none at the end of the file.
  std::optional<LogEvent> next();

  /// Reads the event at an offset reported by next(), without moving next(). Throws FileError when
  /// it is not there.
  LogEvent read_at(std::uint64_t offset);

  const std::vector<LogGap>& gaps() const { return gaps_; }
  std::int64_t num_events() const { return num_events_; }
  std::uint64_t position() const { return position_; }  ///< bytes consumed, for progress
  std::uint64_t file_size() const { return file_size_; }
  const std::string& path() const { return path_; }

 private:
  /// Size of the event at `offset` if its header is plausible; `sync_word`: it must have the sync
  /// word.
  std::optional<std::uint64_t> plausible_size(std::uint64_t offset, bool sync_word = true);
  std::optional<std::uint64_t> find_plausible(std::uint64_t offset);
  std::optional<std::uint64_t> believed_size(std::uint64_t offset);
  std::int64_t event_number_at(std::uint64_t offset);
  LogEvent event_at(std::uint64_t offset, std::uint64_t size);
  void skip_to(std::uint64_t offset);

  std::string path_;
  FileWindow window_;
  std::uint64_t file_size_ = 0;
  std::uint64_t position_ = 0;
  std::int64_t num_events_ = 0;
  std::vector<LogGap> gaps_;
};

}  // namespace orchard::io
