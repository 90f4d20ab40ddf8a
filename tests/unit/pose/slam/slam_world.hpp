// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "detection/detection.hpp"
#include "geometry/angles.hpp"
#include "geometry/pose2.hpp"
#include "pose/measurements.hpp"
#include "simulation/random.hpp"
#include "unit/pose/prior_map/noisy_trunk.hpp"

namespace orchard::pose {
using geometry::compose;
using geometry::inverse_transform;

/// An orchard of points that a robot passes, and what its sensors say: the truth that the tests of
/// SLAM know. Independent of the code under test but for its message structs.
struct SlamWorld {
  struct Tree {
    Eigen::Vector2d p_map;
    double width_m = 0.125;
  };
  std::vector<Tree> trees;
  std::vector<Eigen::Vector2d> waypoints;

  double speed_mps = 1.0;
  double sight_range_m = 5.6;
  double sight_half_angle_rad = 2.09;
  double range_sd_m = 0.01;
  double range_sd_fraction = 0.01;
  double miss_probability = 0.1;
  double false_per_scan = 0.1;
  double speed_scale = 0.03;
  double turn_scale = 0.0;
  double yaw_rate_bias_radps = 0.002;
  double speed_sd_mps = 0.03;
  double yaw_rate_sd_radps = 0.02;
  double odometry_silent_from_s = 1e9;  ///< encoders that fail
  double odometry_silent_to_s = 1e9;

  /// Rows along x, `spacing_m` apart, with gaps and jitter; the robot sweeps every alley in turn,
  /// `laps` times, and comes back along a headland between laps.
  static SlamWorld block(std::uint64_t seed, int rows, int trees_per_row, int laps);

  /// Two rows driven through, then `away_m` out and back where nothing stands, and through them
  /// again. `regular`: no gap and no jitter, one place looks as the next.
  static SlamWorld island(std::uint64_t seed, double away_m, bool regular);
};

/// What a run is told of, in order of time, and where the robot truly is.
struct SlamRun {
  std::function<void(const Odometry&)> odometry;
  std::function<void(const detection::Detections&)> seen;
  std::function<void(std::int64_t utime, const Eigen::Vector3d& T_map_base)> truth;  ///< at scans
};

inline SlamWorld SlamWorld::block(std::uint64_t seed, int rows, int trees_per_row, int laps) {
  simulation::Random random(seed, simulation::Stream::kScene);
  SlamWorld world;
  const double row_m = 4.0;
  const double tree_m = 2.5;
  for (int r = 0; r < rows; ++r) {
    for (int t = 0; t < trees_per_row; ++t) {
      const bool missing = random.uniform() < 0.08;
      const double dx_m = random.uniform(-0.15, 0.15);
      const double dy_m = random.uniform(-0.15, 0.15);
      const double width_m = random.normal(0.125, 0.012);
      if (!missing) world.trees.push_back({{t * tree_m + dx_m, r * row_m + dy_m}, width_m});
    }
  }
  world.speed_scale = random.normal(0.0, 0.03);
  world.turn_scale = random.normal(0.0, 0.01);
  world.yaw_rate_bias_radps = random.normal(0.0, 0.002);
  const double low_m = -2.5;
  const double high_m = (trees_per_row - 1) * tree_m + 2.5;
  bool up = true;
  for (int lap = 0; lap < laps; ++lap) {
    for (int alley = 0; alley + 1 < rows; ++alley) {
      const double y_m = (alley + 0.5) * row_m;
      world.waypoints.push_back({up ? low_m : high_m, y_m});
      world.waypoints.push_back({up ? high_m : low_m, y_m});
      up = !up;
    }
    // clear of the row that it turns around
    if (lap + 1 < laps && rows > 3) {
      const double x_m = up ? low_m - 2.0 : high_m + 2.0;
      world.waypoints.push_back({x_m, (rows - 2) * row_m});
      world.waypoints.push_back({x_m, row_m});
    }
  }
  return world;
}

inline SlamWorld SlamWorld::island(std::uint64_t seed, double away_m, bool regular) {
  simulation::Random random(seed, simulation::Stream::kScene);
  SlamWorld world;
  for (int row = 0; row < 2; ++row) {
    for (int t = 0; t < 16; ++t) {
      const bool missing = !regular && random.uniform() < 0.08;
      const double jitter_m = regular ? 0.0 : 0.15;
      const double dx_m = random.uniform(-jitter_m, jitter_m);
      const double dy_m = random.uniform(-jitter_m, jitter_m);
      if (!missing) world.trees.push_back({{t * 2.5 + dx_m, row * 4.0 + dy_m}});
    }
  }
  world.speed_scale = random.normal(0.0, 0.03);
  world.yaw_rate_bias_radps = random.normal(0.0, 0.002);
  world.waypoints = {{-3.0, 2.0},          {41.0, 2.0}, {45.0, 2.0 + away_m},
                     {-7.0, 2.0 + away_m}, {-7.0, 2.0}, {41.0, 2.0}};
  return world;
}

inline void run(const SlamWorld& world, std::uint64_t seed, const SlamRun& told) {
  using simulation::Random;
  constexpr double kStepS = 0.02;
  Random odometry_noise(seed, simulation::Stream::kOdometry);
  Random scan_noise(seed, simulation::Stream::kScan);
  Eigen::Vector3d T(world.waypoints[0].x(), world.waypoints[0].y(), 0.0);
  const Eigen::Vector2d first = world.waypoints[1] - world.waypoints[0];
  T.z() = std::atan2(first.y(), first.x());
  std::size_t next = 1;
  double yaw_rate_radps = 0.0;
  std::int32_t seq = 0;
  for (int step = 0; next < world.waypoints.size(); ++step) {
    const double t_s = step * kStepS;
    const auto utime = static_cast<std::int64_t>(std::llround(t_s * 1e6)) + 1'000'000;
    if (t_s < world.odometry_silent_from_s || t_s > world.odometry_silent_to_s) {
      Odometry o;
      o.utime = utime;
      o.seq = step;
      o.speed_mps = world.speed_mps * (1.0 + world.speed_scale) +
                    odometry_noise.normal(0.0, world.speed_sd_mps);
      o.yaw_rate_radps = yaw_rate_radps * (1.0 + world.turn_scale) + world.yaw_rate_bias_radps +
                         odometry_noise.normal(0.0, world.yaw_rate_sd_radps);
      o.covariance = {world.speed_sd_mps * world.speed_sd_mps, 0.0,
                      world.yaw_rate_sd_radps * world.yaw_rate_sd_radps};
      told.odometry(o);
    }
    if (step % 5 == 0) {
      detection::Detections seen;
      seen.utime = utime;
      seen.seq = seq++;
      const auto add = [&](const Eigen::Vector2d& p_base, double width_m) {
        const double range_m = p_base.norm();
        const double bearing_rad = std::atan2(p_base.y(), p_base.x());
        const double sd_m = std::hypot(world.range_sd_m, world.range_sd_fraction * range_m);
        detection::Detection trunk = noisy_trunk({range_m, bearing_rad, width_m},
                                                 {sd_m, 0.003, 0.02, 0.005}, 0.02, scan_noise);
        trunk.utime = utime;
        seen.trunks.push_back(trunk);
      };
      for (const SlamWorld::Tree& tree : world.trees) {
        const Eigen::Vector2d p_base = inverse_transform(T, tree.p_map);
        if (p_base.norm() > world.sight_range_m ||
            std::abs(std::atan2(p_base.y(), p_base.x())) > world.sight_half_angle_rad) {
          continue;
        }
        if (scan_noise.uniform() < world.miss_probability) continue;
        add(p_base, tree.width_m);
      }
      if (scan_noise.uniform() < world.false_per_scan) {
        const double range_m = scan_noise.uniform(0.5, world.sight_range_m);
        const double bearing_rad =
            scan_noise.uniform(-world.sight_half_angle_rad, world.sight_half_angle_rad);
        add({range_m * std::cos(bearing_rad), range_m * std::sin(bearing_rad)}, 0.1);
      }
      told.seen(seen);
      if (told.truth) told.truth(utime, T);
    }
    // on to the next leg in time, without a halt that the wheels would not tell of
    Eigen::Vector2d from = Eigen::Vector2d::Zero();
    Eigen::Vector2d leg = Eigen::Vector2d::Zero();
    double length_m = 0.0;
    double along_m = 0.0;
    for (; next < world.waypoints.size(); ++next) {
      from = world.waypoints[next - 1];
      leg = world.waypoints[next] - from;
      length_m = leg.norm();
      along_m = (T.head<2>() - from).dot(leg) / length_m;
      if (along_m < length_m - 0.5) break;
    }
    // steer towards a point ahead on the leg
    const Eigen::Vector2d aim = from + leg / length_m * std::min(length_m, along_m + 1.5);
    const Eigen::Vector2d ahead = inverse_transform(T, aim);
    const double wanted_radps = 1.5 * std::atan2(ahead.y(), ahead.x());
    // the yaw rate changes evenly over the step, from what was told to what will be told
    const double next_radps = std::max(-0.8, std::min(0.8, wanted_radps));
    const double turn_rad = 0.5 * (yaw_rate_radps + next_radps) * kStepS;
    yaw_rate_radps = next_radps;
    T = compose(T, {world.speed_mps * kStepS * std::cos(0.5 * turn_rad),
                    world.speed_mps * kStepS * std::sin(0.5 * turn_rad), turn_rad});
  }
}

}  // namespace orchard::pose
