// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/angles.hpp"
#include "simulation/scene/moving_world.hpp"
#include "simulation/scene/scenes.hpp"

namespace orchard::simulation {
namespace {

constexpr double kSweepWay_m = 5.0;  ///< above a robot's motion during a scan
constexpr double kAboveAll_m = 1e4;  ///< no beam comes down from there

enum Sensor : std::size_t { kScan, kImage, kOdometry, kGnss, kPoseFix, kImu, kScanRear };

Stream stream_of(std::size_t sensor) {
  constexpr std::array<Stream, 7> kStreams{Stream::kScan,    Stream::kImage,   Stream::kOdometry,
                                           Stream::kGnss,    Stream::kPoseFix, Stream::kImu,
                                           Stream::kScanRear};
  return kStreams[sensor];
}

Scene make_level_scene(SceneKind kind, std::uint64_t seed, const RigConfig& rig) {
  if (kind == SceneKind::kTubes) return make_tube_scene(seed, rig);
  if (kind == SceneKind::kPark) return make_park_scene(seed, rig.simulation.park);
  if (kind == SceneKind::kYard) return make_yard_scene(seed, rig.simulation.yard);
  Scene scene = make_orchard_scene(seed, rig.simulation.orchard, rig.simulation.carry);
  add_clutter(seed, rig.simulation, scene);
  change_orchard(seed, rig.simulation.change, scene);
  return scene;
}

Scene make_scene(SceneKind kind, std::uint64_t seed, const RigConfig& rig,
                 const WheeledBody& body) {
  Scene scene = make_level_scene(kind, seed, rig);
  if (body.is_level()) return scene;
  grow_low_branches(seed, rig.simulation, scene);
  stand_on_terrain(body.terrain(), scene);
  return scene;
}

/// The constant range errors of a scene's targets; change_orchard() does not change those of
/// remaining targets.
std::vector<double> target_errors(std::uint64_t seed, const Scene& scene,
                                  const ScannerConfig& scanner) {
  Random random(seed, Stream::kTargets);
  const std::vector<int>& former = scene.former_targets;
  if (former.empty()) return draw_target_errors(scene.world.num_targets, scanner, random);
  const int num_ever = *std::max_element(former.begin(), former.end()) + 1;
  const std::vector<double> drawn = draw_target_errors(num_ever, scanner, random);
  std::vector<double> errors;
  for (const int target : former) errors.push_back(drawn[static_cast<std::size_t>(target)]);
  return errors;
}

}  // namespace

std::optional<SceneKind> find_scene(std::string_view name) {
  if (name == "tubes") return SceneKind::kTubes;
  if (name == "orchard") return SceneKind::kOrchard;
  if (name == "park") return SceneKind::kPark;
  if (name == "yard") return SceneKind::kYard;
  return std::nullopt;
}

Simulator::Simulator(SceneKind kind, std::uint64_t seed, const RigConfig& rig)
    : kind_(kind),
      seed_(seed),
      rig_(rig),
      body_({seed, rig.simulation.terrain}, rig.simulation.terrain),
      scene_(make_scene(kind, seed, rig, body_)),
      index_(scene_.world),
      renderer_(rig),
      receiver_(seed, rig.simulation),
      inertial_unit_(seed, rig.simulation.imu, scene_.path.duration_s(), body_.is_level()),
      wheel_memory_(seed, rig.simulation.wheels, scene_.path.duration_s()) {
  if (rig.camera.enabled) renderer_.cast_shadows(scene_.world);
  target_errors_ = target_errors(seed, scene_, rig.simulation.scanner);
  Random wheels(seed, Stream::kOdometryRun);
  odometry_errors_ = draw_odometry_errors(rig.simulation.motion, rig.simulation.wheels, wheels);

  const SimulationConfig& config = rig.simulation;
  if (scene_.stepped) {
    const double rate_hz = 1.0 / scene_.stop_period_s;
    start_clock(kScan, rate_hz, 0.0);
    if (rig.camera.enabled) start_clock(kImage, rate_hz, 0.0);
    start_clock(kPoseFix, rate_hz, 0.0);
    if (rig.laser_rear.enabled) start_clock(kScanRear, rate_hz, 0.0);
  } else {
    start_clock(kScan, config.scanner.rate_hz, 0.0);
    if (rig.camera.enabled) start_clock(kImage, config.image.rate_hz, config.image.offset_s);
    start_clock(kOdometry, config.motion.odometry_rate_hz, 0.0);
    start_clock(kGnss, config.motion.gnss_rate_hz, 0.0);
    start_clock(kPoseFix, config.orchard.fix_rate_hz, 0.0);
    start_clock(kImu, config.imu.rate_hz, 0.0);
    if (rig.laser_rear.enabled) {
      // The sweeps of two scanners are not synchronised: use an offset of a third of a turn.
      start_clock(kScanRear, config.scanner.rate_hz, 1.0 / (3.0 * config.scanner.rate_hz));
    }
  }
}

void Simulator::start_clock(std::size_t sensor, double rate_hz, double offset_s) {
  if (rate_hz <= 0.0) return;
  Clock& clock = clocks_[sensor];
  clock.period_s = 1.0 / rate_hz;
  clock.offset_s = offset_s;
  clock.count = scene_.stepped ? static_cast<std::int64_t>(scene_.stops.size())
                               : static_cast<std::int64_t>(std::floor(
                                     (scene_.path.duration_s() - offset_s) * rate_hz + 1e-9)) +
                                     1;
}

std::int64_t Simulator::utime_of(std::size_t sensor, std::int64_t index) const {
  const Clock& clock = clocks_[sensor];
  return kEpochUtime +
         std::llround((clock.offset_s + static_cast<double>(index) * clock.period_s) * 1e6);
}

Pose2 Simulator::pose_at(std::int64_t utime) const {
  const double time_s = static_cast<double>(utime - kEpochUtime) * 1e-6;
  if (!scene_.stepped) return scene_.path.pose_at(time_s);
  const auto stop = static_cast<std::size_t>(std::max(0.0, time_s / scene_.stop_period_s + 0.5));
  return scene_.stops[std::min(stop, scene_.stops.size() - 1)];
}

double Simulator::sweep_middle_s(std::int64_t utime) const {
  const ScannerConfig& scanner = rig_.simulation.scanner;
  return static_cast<double>(utime - kEpochUtime) * 1e-6 +
         (scanner.num_beams / 2) * scanner.beam_period_us * 1e-6;
}

Tilt Simulator::tilt_of(std::int64_t scan) const {
  const double sd_rad = rig_.simulation.scanner.tilt_sd_rad;
  if (sd_rad <= 0.0) return {};
  Random random(seed_, Stream::kTilt, static_cast<std::uint64_t>(scan));
  const double pitch_rad = random.normal(0.0, sd_rad);
  return {pitch_rad, random.normal(0.0, sd_rad)};
}

World Simulator::world_at_time(double time_s) const {
  return has_motion(scene_) ? world_at(scene_, time_s) : scene_.world;
}

/// The world within the scanner's range during a sweep; empty while the robot is carried above
/// everything.
World Simulator::world_in_reach(double time_s, const Pose2& T_map_laser) const {
  if (scene_.path.carried_at(time_s)) return {};
  // The truth contains objects up to 1.5 ranges away, and objects within range may hide them.
  const double reach_m = 1.5 * rig_.simulation.scanner.range_max_m + kSweepWay_m;
  return world_near(scene_, index_, T_map_laser.x_m, T_map_laser.y_m, reach_m, time_s);
}

vision::Image Simulator::take_picture(std::int64_t utime, Random& random) const {
  const auto delay_us = std::llround(rig_.simulation.image.stamp_delay_s * 1e6);
  const std::int64_t exposed = utime - delay_us;
  Exposure exposure;
  exposure.time_s = static_cast<double>(exposed - kEpochUtime) * 1e-6;
  if (!scene_.stepped) {
    constexpr double kHalf_s = 0.005;
    exposure.yaw_rate_radps =
        geometry::wrap_angle_rad(scene_.path.pose_at(exposure.time_s + kHalf_s).yaw_rad -
                                 scene_.path.pose_at(exposure.time_s - kHalf_s).yaw_rad) /
        (2.0 * kHalf_s);
  }
  return renderer_.take(world_at_time(exposure.time_s), pose_at(exposed), random, exposure);
}

std::vector<TruthObject> Simulator::truth() const {
  std::vector<TruthObject> standing;
  for (const TruthObject& thing : scene_.truth) {
    if (!thing.moving) standing.push_back(thing);
  }
  return standing;
}

/// T_map_base during a scan: one pose if the robot does not move, else one per beam.
std::vector<Pose2> Simulator::base_poses(std::int64_t utime) const {
  const ScannerConfig& scanner = rig_.simulation.scanner;
  if (scene_.stepped || scanner.beam_period_us <= 0.0) return {pose_at(utime)};
  const double start_s = static_cast<double>(utime - kEpochUtime) * 1e-6;
  std::vector<Pose2> T_map_base;
  for (int beam = 0; beam < scanner.num_beams; ++beam) {
    T_map_base.push_back(scene_.path.pose_at(start_s + beam * scanner.beam_period_us * 1e-6));
  }
  return T_map_base;
}

std::vector<Pose2> Simulator::laser_poses(std::int64_t utime,
                                          const laser::LaserConfig& mount) const {
  const Pose2 T_base_laser{mount.mount_x_m, mount.mount_y_m, mount.mount_yaw_rad};
  std::vector<Pose2> T_map_laser;
  for (const Pose2& T_map_base : base_poses(utime)) {
    T_map_laser.push_back(compose(T_map_base, T_base_laser));
  }
  return T_map_laser;
}

laser::Scan Simulator::take_scan(std::int64_t utime, std::int64_t index,
                                 const laser::LaserConfig& mount, Random& random) const {
  const std::vector<Pose2> T_map_laser = laser_poses(utime, mount);
  const World world = world_in_reach(sweep_middle_s(utime), T_map_laser[T_map_laser.size() / 2]);
  const ScannerConfig& scanner = rig_.simulation.scanner;
  return body_.is_level()
             ? simulate_scan(world, T_map_laser, scanner, target_errors_, random, tilt_of(index))
             : simulate_scan(world, uneven_sweep(utime, mount, tilt_of(index)), scanner,
                             target_errors_, random);
}

/// While the robot is carried there is no ground within reach.
UnevenSweep Simulator::uneven_sweep(std::int64_t utime, const laser::LaserConfig& mount,
                                    const Tilt& tilt) const {
  const TerrainConfig& terrain = rig_.simulation.terrain;
  const double carried_m = scene_.path.carried_at(sweep_middle_s(utime)) ? kAboveAll_m : 0.0;
  const Pose3 T_base_laser{{mount.mount_x_m, mount.mount_y_m, mount.mount_yaw_rad},
                           rig_.simulation.scanner.height_m + carried_m,
                           terrain.laser_pitch_rad + tilt.pitch_rad,
                           terrain.laser_roll_rad + tilt.roll_rad};
  UnevenSweep sweep{body_.terrain(), terrain.grass_height_m, {}};
  for (const Pose2& T_map_base : base_poses(utime)) {
    sweep.T_map_laser.push_back(body_.stand_at(T_map_base).transform() * T_base_laser.transform());
  }
  return sweep;
}

std::optional<SensorMessage> Simulator::make(std::size_t sensor, std::int64_t index,
                                             std::int32_t seq) const {
  const std::int64_t utime = utime_of(sensor, index);
  const double time_s = static_cast<double>(utime - kEpochUtime) * 1e-6;
  Random random(seed_, stream_of(sensor), static_cast<std::uint64_t>(index));
  const auto stamped = [&](auto message) -> SensorMessage {
    message.utime = utime;
    message.seq = seq;
    return message;
  };
  const SimulationConfig& config = rig_.simulation;
  const Pose2 T_map_base = pose_at(utime);
  switch (sensor) {
    case kScan:
      return stamped(take_scan(utime, index, rig_.laser, random));
    case kScanRear:
      return stamped(laser::RearScan{take_scan(utime, index, rig_.laser_rear, random)});
    case kImage:
      return stamped(take_picture(utime, random));
    case kOdometry: {
      const bool carried = scene_.path.carried_at(time_s);
      if (config.wheels.outage.number_at(time_s) >= 0) return std::nullopt;
      if (carried && !config.carry.odometry) return std::nullopt;
      return stamped(
          simulate_odometry(scene_.path, time_s, clocks_[kOdometry].period_s,
                            wheel_memory_.errors_at(odometry_errors_, time_s, T_map_base),
                            config.motion, config.wheels, random, body_));
    }
    case kGnss: {
      const auto fix = receiver_.fix(scene_.path, index, time_s, body_);
      if (!fix) return std::nullopt;
      return stamped(*fix);
    }
    case kImu:
      return stamped(inertial_unit_.sample(scene_.path, index, time_s, body_));
    default:
      return stamped(
          kind_ == SceneKind::kTubes
              ? simulate_fix(T_map_base, config.tubes.fix_sd_m, config.tubes.fix_yaw_sd_rad, random)
              : simulate_fix(T_map_base, config.orchard.fix_sd_m, config.orchard.fix_yaw_sd_rad,
                             random));
  }
}

std::optional<SensorMessage> Simulator::next() {
  while (const std::optional<std::size_t> sensor = next_sensor()) {
    Clock& clock = clocks_[*sensor];
    const auto seq = static_cast<std::int32_t>(clock.num_sent);
    if (auto message = make(*sensor, clock.next++, seq)) {
      ++clock.num_sent;
      return message;
    }
  }
  return std::nullopt;
}

std::optional<std::size_t> Simulator::next_sensor() const {
  std::optional<std::size_t> first;
  std::int64_t first_utime = 0;
  for (std::size_t sensor = 0; sensor < kNumSensors; ++sensor) {
    const Clock& clock = clocks_[sensor];
    if (clock.next >= clock.count) continue;
    const std::int64_t utime = utime_of(sensor, clock.next);
    if (!first || utime < first_utime) {
      first = sensor;
      first_utime = utime;
    }
  }
  return first;
}

std::vector<TruePose> Simulator::true_poses() const {
  std::vector<TruePose> poses;
  for (std::int64_t i = 0; i < clocks_[kScan].count; ++i) {
    const std::int64_t utime = utime_of(kScan, i);
    const Pose3 pose = body_.stand_at(pose_at(utime));
    poses.push_back({utime, pose.horizontal.x_m, pose.horizontal.y_m, pose.horizontal.yaw_rad,
                     pose.z_m, pose.roll_rad, pose.pitch_rad});
  }
  return poses;
}

Surroundings Simulator::surroundings_of_scan(std::int64_t index) const {
  const std::int64_t utime = utime_of(kScan, index);
  const double middle_s = sweep_middle_s(utime);
  std::vector<Pose2> T_map_laser = laser_poses(utime, rig_.laser);
  return {world_in_reach(middle_s, T_map_laser[T_map_laser.size() / 2]), truth_at(scene_, middle_s),
          std::move(T_map_laser), tilt_of(index)};
}

}  // namespace orchard::simulation
