// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

namespace orchard::io {

/// What happened on the line to a device.
enum class RawKind : std::uint8_t {
  kConnected = 'C',     ///< a connection was made; no bytes
  kReceived = 'R',      ///< bytes came from the device
  kSent = 'S',          ///< bytes went to the device
  kClockStepped = 'T',  ///< the host's clock was set; 8 bytes: by how much [us]
};

/// One event on the line to a device.
struct RawEvent {
  std::int64_t utime = 0;  ///< host's clock when the bytes were there to be read [us]
  RawKind kind = RawKind::kReceived;
  std::string bytes;
};

/// Writes a device's raw bytes, to be read again through the parser that read them live. Format:
/// the 8 bytes "ORCHRAW1", then per event big-endian int64 utime, one byte of kind, uint32 size,
/// bytes.
class RawBytesWriter {
 public:
  /// Begins the file anew. Throws FileError.
  explicit RawBytesWriter(const std::string& path);

  /// Throws FileError when the disk is full; what was written before stays readable.
  void write(const RawEvent& event);

 private:
  std::string path_;
  std::ofstream file_;
};

/// Reads what RawBytesWriter wrote.
class RawBytesReader {
 public:
  /// Throws FileError when there is no such file or it is none of raw bytes.
  explicit RawBytesReader(const std::string& path);

  /// The next event, or none at the end. A file that was cut short ends with its last whole event;
  /// throws FileError at one whose kind or size (above 1 MiB) cannot be.
  std::optional<RawEvent> next();

 private:
  std::string path_;
  std::ifstream file_;
};

}  // namespace orchard::io
