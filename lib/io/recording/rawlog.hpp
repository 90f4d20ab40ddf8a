// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/recording_folder.hpp"

namespace orchard::io {

/// Content of an MRPT rawlog.
struct RawlogContent {
  std::vector<SensorMessage> messages;          ///< in order of (utime, kind), numbered from 0
  std::optional<SensorMount> laser_mount;       ///< from the first scan
  std::string laser_label;                      ///< label of the laser that was used
  std::string camera_label;                     ///< label of the camera that was used
  std::map<std::string, std::int64_t> ignored;  ///< count by class name and reason
};

/// Reads an MRPT rawlog, plain or gzip-compressed, of sensory frames or of single observations: 2D
/// scans, images, odometry (absolute, velocities, or increments of an action), GPS (GGA). With
/// several lasers or cameras, the one whose label comes first is used. Unused observations are
/// counted.
///
/// A velocity from increments is the mean over the step, stamped at its end. External images must
/// be in the rawlog's image folder. Throws FileError for a file that is damaged, truncated, empty
/// or of another format. A child process with limited memory reads the file first, because MRPT
/// crashes on some damage; call this only from single-threaded programs, such as the orchard tool.
RawlogContent read_rawlog(const std::string& path);

}  // namespace orchard::io
