// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bus/messages/channel.hpp"
#include "io/config/config.hpp"

namespace orchard::bench {

/// A message of a source as it would stand on the wire.
struct RawMessage {
  std::int64_t utime = 0;
  bus::Channel channel = bus::Channel::kScan;
  std::vector<std::uint8_t> bytes;
};

/// A drive through the simulated orchard: scans at 10 Hz, 320 x 240 JPEGs at 10 Hz, odometry at
/// 50 Hz, and a fix of the position now and then.
struct FieldDrive {
  io::Config config;
  std::string config_path;  ///< the same for other processes
  std::string log_path;
  std::vector<RawMessage> messages;  ///< in the order of the log
  double duration_s = 0.0;
};

/// Simulates the drive and writes its log and configuration into a folder. `fix_rate_hz` is of
/// POSE_FIX. With `fixes_only` each fix is a pose (odometry serves the detector alone), and image
/// and scan have one time.
FieldDrive simulate_field_drive(const std::string& folder, double duration_s, double fix_rate_hz,
                                bool fixes_only);

/// Prints how many messages of which size the drive has.
void describe_drive(const FieldDrive& drive);

}  // namespace orchard::bench
