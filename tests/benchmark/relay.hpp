// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "benchmark/child_process.hpp"

namespace orchard::bench {

/// The same hops as detector, pose and mapper, of processes that compute nothing: bare LCM with raw
/// handlers. A set of messages travels as  SCAN, ODOMETRY, IMAGE -> DETECTIONS,  POSE_FIX -> POSE,
/// DETECTIONS and POSE -> MAP;  each starts with a RelayHeader and is filled up to its real size.
struct RelayHeader {
  std::int64_t utime = 0;
  std::uint32_t num_detector_inputs = 0;  ///< SCAN, ODOMETRY and IMAGE of the set
  std::uint32_t detections_bytes = 0;     ///< size that the DETECTIONS of this set is to have
  std::uint32_t pose_bytes = 0;
  std::uint32_t map_bytes = 0;
};

/// The three processes; they are this program with other arguments. Returns when each of them
/// answers. Throws std::runtime_error when one does not.
std::vector<ChildProcess> start_relays(const std::string& lcm_url, const TemporaryFolder& folder);

bool is_relay(int argc, char** argv);
int run_relay(char** argv);

}  // namespace orchard::bench
