// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "benchmark/child_process.hpp"

namespace orchard::bench {

/// Starts orchard-detector, orchard-pose and orchard-mapper (which saves its map as in the field)
/// and returns when all three have been heard on the bus. Throws std::runtime_error when they are
/// not within 20 s.
std::vector<ChildProcess> start_live_pipeline(const std::string& config_path,
                                              const std::string& lcm_url,
                                              const TemporaryFolder& folder);

}  // namespace orchard::bench
