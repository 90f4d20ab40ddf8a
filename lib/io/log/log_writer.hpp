// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/log/log_event.hpp"

namespace orchard::io {

/// Writes the format of lcm-logger. The file appears under its name only at close(): until then
/// it grows as "<path>.part" beside it, so a killed writer never leaves a half log that looks
/// whole (what it had written can be had with `orchard log repair`).
class LogWriter {
 public:
  /// Throws io::FileError when the file cannot be made, or when another writer is at it.
  explicit LogWriter(const std::string& path);
  ~LogWriter();  ///< without close(): removes the temporary
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// Appends an event; numbers events itself. Throws io::FileError when the disk is full, and for
  /// a channel name or a size that LogReader would refuse.
  void write(std::int64_t timestamp_us, std::string_view channel,
             const std::vector<std::uint8_t>& data);

  /// Syncs and renames. Throws io::FileError.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace orchard::io
