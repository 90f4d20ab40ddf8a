// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/log/log_reader.hpp"

namespace orchard::io {

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
