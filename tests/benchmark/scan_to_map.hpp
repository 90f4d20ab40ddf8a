// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <lcm/lcm-cpp.hpp>
#include <string>
#include <vector>

#include "benchmark/field_drive.hpp"

namespace orchard::bench {

/// What a scan's place in the map needs, the picture last.
struct ScanSet {
  std::int64_t utime = 0;
  std::vector<const RawMessage*> inputs;
  std::uint32_t num_detector_inputs = 0;  ///< SCAN, ODOMETRY and IMAGE of them
};

/// One set per scan that has a picture, in order of time: the scan, everything of the wheels and of
/// the poses until the next scan begins (a sweep takes nearly as long, and its last object is
/// placed by the pose then), and the picture, which takes the longest to be compressed and sent.
/// `drive` outlives them.
std::vector<ScanSet> scan_sets(const FieldDrive& drive);

/// Sends what scans need and waits for their MAP.
class MapProbe {
 public:
  using Clock = std::chrono::steady_clock;

  /// `relayed`: MAP comes from a relay and begins with a RelayHeader.
  MapProbe(const std::string& url, bool relayed);

  void send(bus::Channel channel, const std::vector<std::uint8_t>& bytes);

  /// Milliseconds since the picture was sent; negative when no MAP comes within the time.
  double wait_for_map(std::int64_t utime, Clock::time_point until);

  /// Both for a set as it is.
  double through(const ScanSet& set, Clock::time_point until);

 private:
  void on_map(const lcm::ReceiveBuffer* buffer, const std::string&);

  lcm::LCM lcm_;
  bool relayed_;
  Clock::time_point sent_;
  Clock::time_point received_;
  std::int64_t utime_ = 0;
};

}  // namespace orchard::bench
