// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

namespace orchard::io {

/// Header of an event in lcm-logger's files; big-endian in the file.
struct LogEventHeader {
  static constexpr std::uint32_t kSyncWord = 0xEDA1DA01u;
  static constexpr std::size_t kBytes = 28;

  std::uint32_t sync = 0;
  std::int64_t event_number = 0;
  std::int64_t timestamp_us = 0;
  std::uint32_t channel_bytes = 0;
  std::uint32_t data_bytes = 0;

  std::uint64_t event_bytes() const {
    return kBytes + std::uint64_t{channel_bytes} + std::uint64_t{data_bytes};
  }
};

/// `bytes` must hold at least LogEventHeader::kBytes.
LogEventHeader parse_log_event_header(const std::uint8_t* bytes);
void put_log_event_header(const LogEventHeader& header, std::uint8_t* bytes);

}  // namespace orchard::io
