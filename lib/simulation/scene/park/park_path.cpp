// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/park/park_path.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

constexpr double kStep_m = 1.0;          // length of a piece of constant curvature
constexpr double kLookAhead_m = 12.0;    // look-ahead distance of pure pursuit
constexpr double kLockToLock_m = 9.0;    // distance driven while steering from lock to lock
constexpr double kBorder_m = 10.0;       // border of the ground without waypoints
constexpr double kFormerFraction = 0.5;  // fraction of the waypoints that revisit earlier ones
constexpr double kLegMin_turns = 6.0;    // min distance between waypoints, in turning radii
constexpr int kNumPathTries = 100;

/// The sequence of waypoints.
class Places {
 public:
  Places(std::uint64_t seed, const ParkConfig& config)
      : random_(seed, Stream::kParkPath),
        config_(config),
        leg_min_m_(std::min(kLegMin_turns * config.turn_radius_m,
                            0.4 * std::min(config.length_m, config.width_m))) {}

  Eigen::Vector2d next(const Eigen::Vector2d& from) {
    const bool former = random_.uniform() < kFormerFraction;
    for (int i = 0; former && !been_.empty() && i < kNumPathTries; ++i) {
      const Eigen::Vector2d& place =
          been_[static_cast<std::size_t>(random_.uniform() * static_cast<double>(been_.size()))];
      if ((place - from).norm() >= leg_min_m_) return place;
    }
    Eigen::Vector2d place = Eigen::Vector2d::Zero();
    for (int i = 0; i < kNumPathTries; ++i) {
      const double x = random_.uniform(-0.5, 0.5), y = random_.uniform(-0.5, 0.5);
      place = {x * (config_.length_m - 2.0 * kBorder_m), y * (config_.width_m - 2.0 * kBorder_m)};
      if ((place - from).norm() >= leg_min_m_) break;
    }
    been_.push_back(place);
    return place;
  }

 private:
  Random random_;
  const ParkConfig& config_;
  double leg_min_m_;
  std::vector<Eigen::Vector2d> been_;
};

}  // namespace

DrivePath make_park_path(std::uint64_t seed, const ParkConfig& config) {
  DrivePath path({0.0, 0.0, 0.0}, config.speed_mps);
  Places places(seed, config);
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  Eigen::Vector2d goal = places.next(p);
  const double lock_per_m = 1.0 / config.turn_radius_m;
  // A waypoint counts as reached within the turning circle; otherwise the car could circle around
  // it forever.
  const double reached_m = 2.0 * config.turn_radius_m;
  double curvature_per_m = 0.0;
  while (path.length_m() < config.way_m) {
    const Pose2 now = path.pose_at(path.duration_s());
    p = {now.x_m, now.y_m};
    if ((goal - p).norm() < reached_m) goal = places.next(p);
    const Eigen::Vector2d ahead = goal - p;
    const double aside_rad =
        geometry::wrap_angle_rad(std::atan2(ahead.y(), ahead.x()) - now.yaw_rad);
    const double full =
        std::abs(aside_rad) > 0.5 * geometry::kPi ? 1.0 : std::sin(std::abs(aside_rad));
    const double wanted = std::copysign(2.0 * full / kLookAhead_m, aside_rad);
    const double change = 2.0 * lock_per_m * kStep_m / kLockToLock_m;
    curvature_per_m += std::clamp(wanted - curvature_per_m, -change, change);
    curvature_per_m = std::clamp(curvature_per_m, -lock_per_m, lock_per_m);
    path.append(std::min(kStep_m, config.way_m - path.length_m() + 1e-6), curvature_per_m);
  }
  return path;
}

}  // namespace orchard::simulation
