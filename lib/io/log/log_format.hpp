// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace orchard::io {

/// One event of an LCM log.
struct LogEvent {
  std::uint64_t offset = 0;  ///< of its first byte in the file
  std::int64_t event_number = 0;
  std::int64_t timestamp_us = 0;  ///< time of receipt by lcm-logger (wall clock)
  std::string channel;
  std::vector<std::uint8_t> data;
};

/// Header of an event in lcm-logger's files; big-endian in the file.
struct LogEventHeader {
  static constexpr std::uint32_t kSyncWord = 0xEDA1DA01u;
  static constexpr std::size_t kBytes = 28;
  static constexpr std::uint32_t kMaxChannelBytes = 63;
  static constexpr std::uint32_t kMaxEventBytes = 64u << 20;

  std::uint32_t sync = 0;
  std::int64_t event_number = 0;
  std::int64_t timestamp_us = 0;
  std::uint32_t channel_bytes = 0;
  std::uint32_t data_bytes = 0;

  std::uint64_t event_bytes() const {
    return kBytes + std::uint64_t{channel_bytes} + std::uint64_t{data_bytes};
  }
};

/// Whether the text is a channel name of LCM: 1 to 63 printable characters.
bool is_channel_name(std::string_view text);

/// Appends an event in lcm-logger's format to a buffer.
void append_log_event(std::int64_t event_number, std::int64_t timestamp_us,
                      std::string_view channel, const std::uint8_t* data, std::size_t size,
                      std::vector<std::uint8_t>& buffer);

/// `bytes` must hold at least LogEventHeader::kBytes.
LogEventHeader parse_log_event_header(const std::uint8_t* bytes);
void put_log_event_header(const LogEventHeader& header, std::uint8_t* bytes);

}  // namespace orchard::io
