// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "io/recording/rawlog.hpp"

namespace mrpt::obs {
class CActionCollection;
class CObservation;
class CObservation2DRangeScan;
class CObservationGPS;
class CObservationImage;
class CObservationOdometry;
class CSensoryFrame;
}  // namespace mrpt::obs

namespace orchard::io {

/// Converts MRPT's observations to messages, in the order of the rawlog.
class RawlogCollector {
 public:
  explicit RawlogCollector(const std::string& rawlog_path);

  void add(const mrpt::obs::CObservation& observation);
  void add(const mrpt::obs::CSensoryFrame& frame);
  void add(const mrpt::obs::CActionCollection& actions);
  void ignore(const std::string& what) { ++content_.ignored[what]; }

  RawlogContent take();

 private:
  struct Movement {
    std::optional<std::int64_t> utime;
    double forward_m = 0.0;
    double turn_rad = 0.0;
    bool has_velocity = false;
    double speed_mps = 0.0;
    double yaw_rate_radps = 0.0;
  };

  void add_scan(const mrpt::obs::CObservation2DRangeScan& source);
  void add_image(const mrpt::obs::CObservationImage& source);
  void add_odometry(const mrpt::obs::CObservationOdometry& source);
  void add_gps(const mrpt::obs::CObservationGPS& source);
  void finish_movement(std::optional<std::int64_t> utime);
  void add_step(std::int64_t from_utime, std::int64_t to_utime, double forward_m, double turn_rad);

  std::string path_;
  RawlogContent content_;
  bool has_camera_ = false;
  std::optional<Movement> movement_;  ///< waits for the time of its end
  std::optional<std::int64_t> last_movement_utime_;
  struct Place {
    std::int64_t utime;
    double x_m, y_m, yaw_rad;
  };
  std::optional<Place> last_place_;
};

}  // namespace orchard::io
