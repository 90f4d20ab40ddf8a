// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/recording/recording_csv.hpp"
#include "io/recording/sensor_message.hpp"

namespace orchard::io {

/// Reads a recording folder: sensors.yaml, scans.csv[.gz], and any of intensities.csv[.gz],
/// odometry.csv, poses.csv, gnss.csv (each also .gz), images/<utime_us>.jpg.
///
/// Errors are not corrected: each is a FileError naming file, line and remedy. Messages come in
/// order of (utime, kind), one at a time; memory holds one of each kind.
class RecordingFolder {
 public:
  /// Throws FileError when the path is not a folder, or has no sensors.yaml or no scans.
  explicit RecordingFolder(const std::string& path);
  ~RecordingFolder();
  RecordingFolder(const RecordingFolder&) = delete;
  RecordingFolder& operator=(const RecordingFolder&) = delete;

  /// Laser parameters of sensors.yaml; the mount belongs in the rig's configuration.
  const LaserDescription& laser() const;

  /// Returns the next message; none at the end. Throws FileError.
  std::optional<SensorMessage> next();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads all messages of a recording folder. Throws FileError.
std::vector<SensorMessage> read_recording_folder(const std::string& path);

}  // namespace orchard::io
