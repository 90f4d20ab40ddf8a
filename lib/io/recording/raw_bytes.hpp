// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace orchard::io {

/// Kind of an event on the line to a device.
enum class RawKind : std::uint8_t {
  kConnected = 'C',     ///< the connection was opened; no bytes
  kReceived = 'R',      ///< bytes received from the device
  kSent = 'S',          ///< bytes sent to the device
  kClockStepped = 'T',  ///< the host's clock was set; 8 bytes: the step [us]
};

/// One event on the line to a device.
struct RawEvent {
  std::int64_t utime = 0;  ///< host clock when the bytes could be read [us]
  RawKind kind = RawKind::kReceived;
  std::string bytes;
};

/// Records a device's raw bytes for replay through the same protocol. Format: the 8 bytes
/// "ORCHRAW1", then per event big-endian int64 utime, one byte of kind, uint32 size, bytes.
class RawBytesWriter {
 public:
  /// Creates or overwrites the file. Throws FileError.
  explicit RawBytesWriter(const std::string& path);

  /// Throws FileError when the disk is full; earlier events remain readable.
  void write(const RawEvent& event);

 private:
  std::string path_;
  std::ofstream file_;
};

/// Reads files of RawBytesWriter.
class RawBytesReader {
 public:
  /// Throws FileError when the file does not exist or has another format.
  explicit RawBytesReader(const std::string& path);

  /// Returns the next event, or none at the end. A truncated file ends with its last complete
  /// event. Throws FileError at an invalid kind or size (above 1 MiB).
  std::optional<RawEvent> next();

 private:
  std::string path_;
  std::ifstream file_;
};

}  // namespace orchard::io
