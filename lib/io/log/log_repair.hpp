// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/log/log_reader.hpp"

namespace orchard::io {

/// What a repair could read, and what it could not.
struct LogRepair {
  std::int64_t num_events = 0;       ///< copied
  std::uint64_t num_lost_bytes = 0;  ///< in gaps
  std::vector<LogGap> gaps;
};

/// Copies every event that can be read; they are numbered anew. Throws FileError when either file
/// fails, when both are one, and when no event can be read.
/// `progress` is told the bytes read and those of the whole file; what it throws passes through,
/// and nothing is written then.
LogRepair repair_log(const std::string& path, const std::string& out_path,
                     const std::function<void(std::uint64_t, std::uint64_t)>& progress = {});

}  // namespace orchard::io
