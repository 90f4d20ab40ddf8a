// SPDX-License-Identifier: BSD-3-Clause
#include "system/moving_robot/weaving_drive.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "geometry/angles.hpp"
#include "simulation/scene/scenes.hpp"
#include "simulation/sensor/camera_renderer.hpp"
#include "simulation/sensor/laser_model.hpp"
#include "simulation/sensor/motion_sensors.hpp"

namespace orchard::test {
namespace {

using simulation::DrivePath;
using simulation::Pose2;
using simulation::Random;
using simulation::Stream;

constexpr std::int64_t kStart_us = 1'000'000'000;
constexpr std::int64_t kScanPeriod_us = 100'000;
constexpr std::int64_t kOdometryPeriod_us = 20'000;
constexpr double kSpeed_mps = 1.0;
constexpr double kYawRate_radps = 0.5;
/// The truth with a little noise, so that the pose does not hide what is measured here.
constexpr double kFixSd_m = 0.003;
constexpr double kFixYawSd_rad = 0.001;

/// Swings 0.3 rad to either side of the row's direction.
DrivePath weaving_path(double length_m) {
  const double curvature = kYawRate_radps / kSpeed_mps;
  const double quarter_m = 0.3 / curvature;
  DrivePath path({0.0, 0.0, geometry::kPi / 2.0}, kSpeed_mps);
  path.append(1.0, 0.0);
  path.append(quarter_m, curvature);
  for (double side = -1.0; path.length_m() < length_m; side = -side) {
    path.append(2.0 * quarter_m, side * curvature);
  }
  return path;
}

struct Bench {
  Bench(std::uint64_t seed_, const io::Config& config)
      : seed(seed_),
        rig{config.laser, config.camera, config.simulation, {}},
        scene(simulation::make_orchard_scene(seed_, config.simulation.orchard)),
        renderer(rig),
        path(std::make_shared<DrivePath>(weaving_path(config.simulation.orchard.trees_per_row *
                                                      config.simulation.orchard.tree_spacing_m))) {
    Random targets(seed, Stream::kTargets);
    target_errors =
        simulation::draw_target_errors(scene.world.num_targets, rig.simulation.scanner, targets);
  }

  int num_scans() const { return static_cast<int>(path->duration_s() * 10.0) - 2; }
  static double seconds(std::int64_t utime) {
    return 1e-6 * static_cast<double>(utime - kStart_us);
  }

  laser::Scan scan(int i, std::int64_t utime, bool moving) const {
    const auto& scanner = rig.simulation.scanner;
    const Pose2 T_base_laser{rig.laser.mount_x_m, rig.laser.mount_y_m, rig.laser.mount_yaw_rad};
    const double start_s = 0.1 * i;
    std::vector<Pose2> T_map_laser;
    for (int beam = 0; beam < (moving ? scanner.num_beams : 1); ++beam) {
      const double time_s = start_s + 1e-6 * beam * scanner.beam_period_us;
      T_map_laser.push_back(geometry::compose(path->pose_at(time_s), T_base_laser));
    }
    Random random(seed, Stream::kScan, static_cast<std::uint64_t>(i));
    auto scan = simulation::simulate_scan(scene.world, T_map_laser, scanner, target_errors, random);
    scan.utime = utime;
    scan.seq = i;
    return scan;
  }

  vision::Image image(int i, double exposed_s, std::int64_t utime) const {
    Random random(seed, Stream::kImage, static_cast<std::uint64_t>(i));
    auto image = renderer.take(scene.world, path->pose_at(exposed_s), random);
    image.utime = utime;
    image.seq = i;
    return image;
  }

  pose::PoseFix fix(int i, std::int64_t utime) const {
    Random random(seed, Stream::kPoseFix, static_cast<std::uint64_t>(i));
    auto fix = simulation::simulate_fix(path->pose_at(0.1 * i), kFixSd_m, kFixYawSd_rad, random);
    fix.utime = utime;
    fix.seq = i;
    return fix;
  }

  std::uint64_t seed;
  simulation::RigConfig rig;
  simulation::Scene scene;
  simulation::CameraRenderer renderer;
  std::shared_ptr<const DrivePath> path;
  std::vector<double> target_errors;
};

RobotRun finish(const Bench& bench, std::vector<bus::Message> messages) {
  std::stable_sort(messages.begin(), messages.end(), [](const auto& a, const auto& b) {
    return bus::utime_of(a) < bus::utime_of(b);
  });
  RobotRun run;
  run.messages = std::move(messages);
  run.truth = bench.scene.truth;
  return run;
}

}  // namespace

RobotRun drive(std::uint64_t seed, const io::Config& config, const CameraTiming& timing) {
  const Bench bench(seed, config);
  std::vector<bus::Message> messages;
  Random wheels(seed, Stream::kOdometryRun);
  const auto errors =
      simulation::draw_odometry_errors(config.simulation.motion, config.simulation.wheels, wheels);
  const std::int64_t exposure_us = std::llround(1e6 * timing.exposure_s);
  const std::int64_t stamp_delay_us = std::llround(1e6 * timing.stamp_delay_s);
  for (int i = 0; i < bench.num_scans(); ++i) {
    const std::int64_t utime = kStart_us + i * kScanPeriod_us;
    messages.emplace_back(bench.scan(i, utime, true));
    messages.emplace_back(
        bench.image(i, 0.1 * i + timing.exposure_s, utime + exposure_us + stamp_delay_us));
    messages.emplace_back(bench.fix(i, utime));
  }
  for (int i = 0; i < bench.num_scans() * 5; ++i) {
    Random random(seed, Stream::kOdometry, static_cast<std::uint64_t>(i));
    auto odometry =
        simulation::simulate_odometry(*bench.path, 0.02 * i, 0.02, errors, config.simulation.motion,
                                      config.simulation.wheels, random);
    odometry.utime = kStart_us + i * kOdometryPeriod_us;
    odometry.seq = i;
    messages.emplace_back(odometry);
  }
  RobotRun run = finish(bench, std::move(messages));
  run.pose_at = [path = bench.path](std::int64_t utime) {
    return path->pose_at(Bench::seconds(utime));
  };
  return run;
}

RobotRun stop_and_go(std::uint64_t seed, const io::Config& config) {
  const Bench bench(seed, config);
  std::vector<bus::Message> messages;
  constexpr std::int64_t kStop_us = 1'000'000;
  for (int i = 0; i < bench.num_scans(); ++i) {
    const std::int64_t utime = kStart_us + i * kStop_us;
    messages.emplace_back(bench.scan(i, utime, false));
    messages.emplace_back(bench.image(i, 0.1 * i, utime + 37'500));
    messages.emplace_back(bench.fix(i, utime));
  }
  RobotRun run = finish(bench, std::move(messages));
  run.pose_at = [path = bench.path](std::int64_t utime) {
    return path->pose_at(0.1 * static_cast<double>((utime - kStart_us) / kStop_us));
  };
  return run;
}

}  // namespace orchard::test
