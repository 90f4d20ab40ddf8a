// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace orchard::io {

/// One event of an LCM log as it stands in the file.
struct LogEvent {
  std::uint64_t offset = 0;  ///< of its first byte in the file
  std::int64_t event_number = 0;
  std::int64_t timestamp_us = 0;  ///< when lcm-logger received it (wall clock)
  std::string channel;
  std::vector<std::uint8_t> data;
};

}  // namespace orchard::io
