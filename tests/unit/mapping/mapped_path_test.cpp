// SPDX-License-Identifier: BSD-3-Clause
// Where fixes err together for seconds, the pose told jumps, and jumps back when they end. No robot
// does: the path in the map must not. Truth: the drive's own speed.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/pose2.hpp"
#include "io/config/config.hpp"
#include "pose/filter/fusion.hpp"
#include "pose/slam/trunk_slam.hpp"
#include "simulation/simulator.hpp"
#include "timing/units.hpp"
#include "unit/pose/slam/slam_world.hpp"
#include "worlds/mapped_path.hpp"

namespace orchard {
namespace {

/// The longest way by which a step of a path is longer than the robot drives in its time [m].
double excess_most_m(const std::vector<pose::PoseEstimate>& path, double speed_mps) {
  double most_m = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const double way_m = std::hypot(path[i].x_m - path[i - 1].x_m, path[i].y_m - path[i - 1].y_m);
    most_m =
        std::max(most_m, way_m - speed_mps * timing::seconds(path[i].utime - path[i - 1].utime));
  }
  return most_m;
}

/// What the wheels and the fixes between two poses may err by: a decimetre, where a fix of a burst
/// errs by a hundred metres.
constexpr double kNoise_m = 0.2;

constexpr std::int64_t kUntil_us = 600'000'000;

class MappedPathSeeds : public testing::TestWithParam<int> {};

/// A park at 3 m/s; satellite fixes in bursts with gaps, of which one in five is reflected, and for
/// nine seconds of each minute all err by the same 100 m.
TEST_P(MappedPathSeeds, FusedDoesNotLeap) {
  io::Config config = io::load_config(ORCHARD_SOURCE_DIR "/config/park.yaml");
  config.pose.mode = pose::PoseMode::kFused;
  config.pose.gnss.datum = config.simulation.motion.datum;
  config.simulation.scanner.rate_hz = 0.0;
  config.simulation.motion.gnss_rate_hz = 5.0;
  config.simulation.motion.gnss_sd_m = 0.5;
  auto& receiver = config.simulation.gnss;
  receiver.jump_m = 100.0;
  receiver.jump = {30.0, 9.0, 60.0};
  receiver.sky.wander_sd_m = 1.7;
  receiver.sky.gap_every_s = 40.0;
  receiver.sky.burst_s = 8.0;
  receiver.sky.pause_s = 3.0;
  receiver.sky.multipath_fraction = 0.2;
  simulation::Simulator simulator(
      simulation::SceneKind::kPark, static_cast<std::uint64_t>(GetParam()),
      {config.laser, config.camera, config.simulation, config.laser_rear});
  pose::Fusion localiser(config.pose);
  MappedPath mapped(config.mapper.pose_gap_max_s);
  double told_most_m = 0.0;
  std::optional<pose::PoseEstimate> before;
  while (const auto message = simulator.next()) {
    if (const auto* odometry = std::get_if<pose::Odometry>(&*message)) {
      if (odometry->utime > simulation::kEpochUtime + kUntil_us) break;
      localiser.add(pose::Measurement(*odometry));
    } else if (const auto* gnss = std::get_if<pose::Gnss>(&*message)) {
      localiser.add(pose::Measurement(*gnss));
    } else {
      continue;
    }
    mapped.hear(localiser);
    const auto now = localiser.estimate();
    if (before && now) told_most_m = std::max(told_most_m, excess_most_m({*before, *now}, 3.0));
    before = now;
  }
  EXPECT_GT(told_most_m, 5.0);  // else nothing is tried
  ASSERT_TRUE(mapped.finish(localiser));
  const auto path = mapped.poses();
  ASSERT_GT(path.size(), 10'000u);
  EXPECT_LT(excess_most_m(path, 3.0), kNoise_m);
}

/// A block at 1 m/s, with fixes of 2 cm that err by the same 5 m for ten seconds of each minute.
TEST_P(MappedPathSeeds, SlamWithFixesDoesNotLeap) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  pose::PoseConfig config;
  config.slam.use_fixes = true;
  pose::TrunkSlam slam(config);
  MappedPath mapped(2.0);
  simulation::Random noise(seed);
  int num_scans = 0;
  Eigen::Vector2d off_m = Eigen::Vector2d::Zero();
  const auto add = [&](const pose::Measurement& measurement) {
    slam.add(measurement);
    mapped.hear(slam);
  };
  run(pose::SlamWorld::block(seed, 3, 16, 2), seed,
      {[&](const pose::Odometry& o) { add(o); },
       [&](const detection::Detections& seen) { add(seen); },
       [&](std::int64_t utime, const Eigen::Vector3d& T_map_base) {
         const double time_s = ++num_scans / 10.0;
         if (num_scans % 2 != 0) return;
         if (std::fmod(time_s, 60.0) < 0.2) {
           const double towards_rad = noise.uniform(-geometry::kPi, geometry::kPi);
           off_m = 5.0 * Eigen::Vector2d(std::cos(towards_rad), std::sin(towards_rad));
         }
         const bool errs = time_s > 60.0 && std::fmod(time_s, 60.0) < 10.0;
         pose::PoseFix fix;
         fix.utime = utime;
         fix.x_m = T_map_base.x() + noise.normal(0.0, 0.02) + (errs ? off_m.x() : 0.0);
         fix.y_m = T_map_base.y() + noise.normal(0.0, 0.02) + (errs ? off_m.y() : 0.0);
         fix.covariance = {4e-4, 0.0, 0.0, 4e-4, 0.0, 0.0};
         add(fix);
       }});
  ASSERT_TRUE(mapped.finish(slam));
  const auto path = mapped.poses();
  ASSERT_GT(path.size(), 1'000u);
  EXPECT_LT(excess_most_m(path, 1.0), kNoise_m);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MappedPathSeeds, testing::Range(21, 25));

}  // namespace
}  // namespace orchard
