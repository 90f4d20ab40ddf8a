// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "laser/scan.hpp"
#include "pose/measurements.hpp"
#include "simulation/scene/moving_world.hpp"
#include "simulation/scene/scene.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/scene/wheeled_body.hpp"
#include "simulation/sensor/camera_renderer.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "simulation/sensor/motion_sensors.hpp"
#include "vision/image.hpp"

namespace orchard::simulation {

/// A message of a simulated sensor. The alternatives are in the order of bus::Channel.
using SensorMessage = std::variant<laser::Scan, vision::Image, pose::Odometry, pose::Gnss,
                                   pose::PoseFix, pose::Imu, laser::RearScan>;

/// Start of simulated time: 2013-12-02 00:00 UTC, the day ACRA 2013 opened [us].
inline constexpr std::int64_t kEpochUtime = 1385942400000000;

/// The scene "tubes", "orchard", "park" or "yard"; none for any other name.
std::optional<SceneKind> find_scene(std::string_view name);

/// World and truth in the middle of a sweep, with one pose, or one per beam.
struct Surroundings {
  World world;
  std::vector<TruthObject> truth;
  std::vector<Pose2> T_map_laser;
  Tilt tilt;
};

/// Simulates a robot that drives through a scene: its sensors' messages one by one in the order of
/// (utime, kind), all from one seed. Every message has its own random numbers, so disabling a
/// sensor leaves the bytes of the others unchanged.
class Simulator {
 public:
  Simulator(SceneKind kind, std::uint64_t seed, const RigConfig& rig);

  /// The next message, or none at the end of the run.
  std::optional<SensorMessage> next();

  /// The truth of the static objects, without people.
  std::vector<TruthObject> truth() const;
  const Scene& scene() const { return scene_; }

  /// True if the ground is level, and truth and poses have no heights.
  bool is_level() const { return body_.is_level(); }

  /// True poses of base: at every stop, or at the first beam of every sweep.
  std::vector<TruePose> true_poses() const;

  std::int64_t num_scans() const { return clocks_[0].count; }
  std::int64_t scan_utime(std::int64_t index) const { return utime_of(0, index); }

  /// What decides of scan `index` (its seq), apart from noise, on level ground.
  Surroundings surroundings_of_scan(std::int64_t index) const;

 private:
  static constexpr std::size_t kNumSensors = std::variant_size_v<SensorMessage>;
  struct Clock {
    std::int64_t count = 0;     ///< messages in the whole run without outages
    std::int64_t next = 0;      ///< index of the next one
    std::int64_t num_sent = 0;  ///< messages sent; fewer than `next` after outages
    double period_s = 1.0;
    double offset_s = 0.0;
  };

  void start_clock(std::size_t sensor, double rate_hz, double offset_s);
  std::int64_t utime_of(std::size_t sensor, std::int64_t index) const;
  Pose2 pose_at(std::int64_t utime) const;
  std::optional<std::size_t> next_sensor() const;
  std::optional<SensorMessage> make(std::size_t sensor, std::int64_t index, std::int32_t seq) const;
  std::vector<Pose2> base_poses(std::int64_t utime) const;
  std::vector<Pose2> laser_poses(std::int64_t utime, const laser::LaserConfig& mount) const;
  laser::Scan take_scan(std::int64_t utime, std::int64_t index, const laser::LaserConfig& mount,
                        Random& random) const;
  UnevenSweep uneven_sweep(std::int64_t utime, const laser::LaserConfig& mount,
                           const Tilt& tilt) const;
  double sweep_middle_s(std::int64_t utime) const;
  Tilt tilt_of(std::int64_t scan) const;
  World world_at_time(double time_s) const;
  World world_in_reach(double time_s, const Pose2& T_map_laser) const;
  vision::Image take_picture(std::int64_t utime, Random& random) const;

  SceneKind kind_;
  std::uint64_t seed_;
  RigConfig rig_;
  WheeledBody body_;
  Scene scene_;
  WorldIndex index_;
  CameraRenderer renderer_;
  std::vector<double> target_errors_;
  SatelliteReceiver receiver_;
  InertialUnit inertial_unit_;
  OdometryErrors odometry_errors_;
  WheelErrorModel wheel_memory_;
  std::array<Clock, kNumSensors> clocks_{};
};

}  // namespace orchard::simulation
