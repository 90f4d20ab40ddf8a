// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <limits>
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
  laser::SegmentationConfig objects;
};

/// Makes what a tilted robot measures horizontal: scans by ScanLeveller, the speed of wheels along
/// a slope, rates of turn about a tilted axis. What comes after it lives on a level map.
class Leveller {
 public:
  using Input = std::variant<Imu, Odometry, laser::Scan, laser::RearScan>;

  explicit Leveller(const LevellingConfig& config);

  void add(Input input);
  /// The next input in order of time, levelled; a scan comes after the IMU of its last beam, or
  /// when that is late.
  std::optional<Input> take();
  /// The same at the end of the inputs, without waiting.
  std::optional<Input> take_flushed();

  /// The tilt at a time near the newest IMU; none without one, and for a tilt that no robot has.
  std::optional<Attitude> tilt_at(std::int64_t utime) const;

  /// Says that scans came without an IMU; empty if there were none.
  std::string warning() const;

 private:
  template <class Pop>
  std::optional<Input> take_of(const Pop& pop, bool is_end);
  bool is_swept(bool is_end) const;
  void give_up_late(std::int64_t utime);
  Input levelled(Input input);
  void level(Imu& imu);
  void level(Odometry& odometry);
  void level(laser::Scan& scan);
  void level(laser::RearScan& scan);
  void level(laser::Scan& scan, ScanLeveller& leveller);

  LevellingConfig config_;
  timing::OrderedQueue<Input, std::variant_size_v<Input>> queue_;
  std::deque<Input> sweeps_;  ///< scans in order that wait for the tilt at their last beams
  std::int64_t newest_imu_utime_ = std::numeric_limits<std::int64_t>::min();
  bool is_imu_missing_ = false;  ///< others waited for it in vain, and none has come since
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
