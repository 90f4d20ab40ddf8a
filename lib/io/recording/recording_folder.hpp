// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/csv.hpp"
#include "laser/scan.hpp"
#include "pose/measurements.hpp"
#include "vision/image.hpp"

namespace orchard::io {

/// A message of a recording; messages of equal time are ordered by alternative.
using SensorMessage = std::variant<laser::Scan, vision::Image, pose::Odometry, pose::Gnss,
                                   pose::PoseFix, pose::Imu, laser::RearScan>;

inline std::int64_t utime_of(const SensorMessage& message) {
  return std::visit([](const auto& m) { return m.utime; }, message);
}

/// Pose of a sensor on the robot, T_base_sensor in the plane, as given in the recording.
struct SensorMount {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

/// Sorts messages by (utime, alternative) and numbers each kind from 0.
void sort_and_number(std::vector<SensorMessage>& messages);

/// Laser parameters in sensors.yaml.
struct LaserDescription {
  int num_beams = 0;
  double bearing_min_rad = 0.0;  ///< laser frame, x forward, counter-clockwise positive
  double bearing_step_rad = 0.0;
  /// Time between neighbouring beams; 0: unknown; negative: the last beam is measured first, as
  /// where a head turns clockwise and its beams are told counter-clockwise. utime is of the first.
  double beam_period_us = 0.0;
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  SensorMount mount;
};

/// Reads scans: `utime_us`, then one range in metres per beam (0 = no return); a second table has
/// the intensities of the same lines.
class ScanCsv {
 public:
  ScanCsv(CsvReader ranges, const LaserDescription& laser,
          std::optional<CsvReader> intensities = std::nullopt);
  std::optional<laser::Scan> next();

 private:
  void read_intensities(laser::Scan& scan);

  CsvReader csv_;
  LaserDescription laser_;
  std::optional<CsvReader> intensities_;
  std::int64_t utime_ = -1;
  std::int32_t seq_ = -1;
};

/// Tables of a recording folder, without covariance: `utime_us,v_mps,yaw_rate_radps`,
/// `utime_us,latitude_deg,longitude_deg,altitude_m`, and `utime_us,x_m,y_m,yaw_rad`.
TimedCsv<pose::Odometry> odometry_csv(CsvReader csv);
TimedCsv<pose::Gnss> gnss_csv(CsvReader csv);
TimedCsv<pose::PoseFix> pose_fix_csv(CsvReader csv);

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
