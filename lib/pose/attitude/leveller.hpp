// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "laser/laser_config.hpp"
#include "laser/scan.hpp"
#include "pose/attitude/attitude_filter.hpp"
#include "pose/attitude/ground_plane.hpp"
#include "pose/attitude/levelled_scan.hpp"
#include "pose/measurements.hpp"
#include "timing/ordered_queue.hpp"

namespace orchard::pose {

/// What levelling needs to know of a rig.
struct LevellingConfig {
  laser::LaserConfig laser;
  laser::LaserConfig laser_rear;
  bool has_wheels = false;
  double wait_s = 0.0;  ///< how long others wait for a late IMU or ODOMETRY [s of message time]
  laser::SegmentationConfig objects;
};

/// Makes what a tilted robot measures horizontal: scans by ScanLeveller, the speed of wheels along
/// a slope, rates of turn about a tilted axis. What comes after it lives on a level map.
class Leveller {
 public:
  using Input = std::variant<Imu, Odometry, laser::Scan, laser::RearScan>;

  explicit Leveller(const LevellingConfig& config);

  void add(Input input);
  /// The next input in order of time, levelled; a scan has the time of its last beam, and none is
  /// given before the IMU has come up to it or is late.
  std::optional<Input> take();
  /// The same at the end of the inputs, without waiting.
  std::optional<Input> take_flushed();

  /// Says that scans came without an IMU; empty if there were none.
  std::string warning() const;

 private:
  Input levelled(Input input);
  void level(Imu& imu);
  void level(Odometry& odometry);
  void level(laser::Scan& scan);
  void level(laser::RearScan& scan);
  void level(laser::Scan& scan, ScanLeveller& leveller);

  LevellingConfig config_;
  timing::OrderedQueue<Input, std::variant_size_v<Input>> queue_;
  AttitudeFilter attitude_;
  GroundPlane ground_;
  ScanLeveller front_;
  ScanLeveller rear_;
  std::optional<std::int64_t> imu_utime_;
  double speed_mps_;
  std::int64_t num_scans_ = 0;
  std::int64_t num_unlevelled_ = 0;
};

}  // namespace orchard::pose
