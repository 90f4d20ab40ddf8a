// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
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

}  // namespace orchard::io
