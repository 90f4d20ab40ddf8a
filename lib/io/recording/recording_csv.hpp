// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "io/csv.hpp"
#include "io/recording/sensor_message.hpp"

namespace orchard::io {

/// Laser parameters in sensors.yaml.
struct LaserDescription {
  int num_beams = 0;
  double bearing_min_rad = 0.0;  ///< laser frame, x forward, counter-clockwise positive
  double bearing_step_rad = 0.0;
  double beam_period_us = 0.0;  ///< 0: unknown
  double range_min_m = 0.0;
  double range_max_m = 0.0;
  SensorMount mount;
};

/// Base of the readers for the tables of a recording folder. Every next() returns the next line
/// with seq from 0, none at the end, and throws FileError naming file, line and column, also when
/// time does not increase.
class RecordingCsv {
 protected:
  explicit RecordingCsv(CsvReader csv) : csv_(std::move(csv)) {}
  /// Reads a line and its utime.
  bool next_line();

  CsvReader csv_;
  std::int64_t utime_ = -1;
  std::int32_t seq_ = -1;
};

/// Reads scans: `utime_us`, then one range in metres per beam (0 = no return); a second table has
/// the intensities of the same lines.
class ScanCsv : RecordingCsv {
 public:
  ScanCsv(CsvReader ranges, const LaserDescription& laser,
          std::optional<CsvReader> intensities = std::nullopt);
  std::optional<laser::Scan> next();

 private:
  void read_intensities(laser::Scan& scan);

  LaserDescription laser_;
  std::optional<CsvReader> intensities_;
};

/// Reads odometry: `utime_us,v_mps,yaw_rate_radps`, without covariance.
class OdometryCsv : RecordingCsv {
 public:
  explicit OdometryCsv(CsvReader csv);
  std::optional<pose::Odometry> next();
};

/// Reads GNSS fixes: `utime_us,latitude_deg,longitude_deg,altitude_m`, without covariance.
class GnssCsv : RecordingCsv {
 public:
  explicit GnssCsv(CsvReader csv);
  std::optional<pose::Gnss> next();
};

/// Reads pose fixes: `utime_us,x_m,y_m,yaw_rad`, without covariance; yaw is wrapped into (-pi, pi].
class PoseFixCsv : RecordingCsv {
 public:
  explicit PoseFixCsv(CsvReader csv);
  std::optional<pose::PoseFix> next();
};

}  // namespace orchard::io
