// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "benchmark/child_process.hpp"

namespace orchard::bench {

/// Plays a log with lcm-logplayer --speed=0 on the URL and returns how many of its messages a plain
/// LCM subscriber, a process of its own, got. `queue_capacity` is of its subscription; 0 = no
/// limit.
std::int64_t count_played(const std::string& log_path, const std::string& lcm_url,
                          int queue_capacity, const TemporaryFolder& folder);

/// The subscriber's process is this program with other arguments.
bool is_counter(int argc, char** argv);
int run_counter(char** argv);

}  // namespace orchard::bench
