// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/log/log_event.hpp"

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

}  // namespace orchard::io
