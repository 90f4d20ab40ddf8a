// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/log/log_format.hpp"
#include "io/log/log_reader.hpp"

namespace orchard::io {

/// Writes lcm-logger's format. Until close() the file grows as "<path>.part" and is then renamed,
/// so a killed writer never leaves a partial log under the final name. `orchard log repair`
/// recovers the partial file.
class LogWriter {
 public:
  /// Throws io::FileError when the file cannot be created or another writer has it open.
  explicit LogWriter(const std::string& path);
  ~LogWriter();  ///< without close(): removes the temporary file
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// Appends an event and numbers it. Throws io::FileError when the disk is full, and for a channel
  /// name or a size that LogReader would reject.
  void write(std::int64_t timestamp_us, std::string_view channel,
             const std::vector<std::uint8_t>& data);

  /// Syncs and renames the file. Throws io::FileError.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Result of a repair.
struct LogRepair {
  std::int64_t num_events = 0;       ///< copied
  std::uint64_t num_lost_bytes = 0;  ///< in gaps
  std::vector<LogGap> gaps;
};

/// Copies every readable event to a new log and renumbers the events. Throws FileError when either
/// file fails, when both are the same, and when no event can be read.
/// `progress` receives the bytes read and the file size; an exception from it is passed on, and
/// nothing is written.
LogRepair repair_log(const std::string& path, const std::string& out_path,
                     const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace orchard::io
