// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/sensor_message.hpp"

namespace orchard::io {

/// What a rawlog (MRPT) held.
struct RawlogContent {
  std::vector<SensorMessage> messages;          ///< in order of (utime, kind), numbered from 0
  std::optional<SensorMount> laser_mount;       ///< of the first scan
  std::string laser_label;                      ///< of the one laser that was taken
  std::string camera_label;                     ///< of the one camera that was taken
  std::map<std::string, std::int64_t> ignored;  ///< count by class name and reason
};

/// Reads an MRPT rawlog, plain or gzip-compressed, of sensory frames or of observations alone:
/// 2D scans, images, odometry (absolute, velocities, or increments of an action), GPS (GGA). Of
/// several lasers or cameras the first one's label is taken. What is not used is counted.
///
/// A speed from increments is the mean over the step stamped at its end. Pictures kept
/// outside must lie in the rawlog's image folder. Throws FileError for a file that is damaged,
/// cut short, none, or empty. A child process of limited memory reads the file first, because MRPT
/// dies at some damage: for programs of one thread, such as the orchard tool.
RawlogContent read_rawlog(const std::string& path);

}  // namespace orchard::io
