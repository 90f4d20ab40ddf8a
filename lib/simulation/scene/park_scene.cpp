// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/scenes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geometry/angles.hpp"
#include "geometry/point_grid.hpp"
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
class Waypoints {
 public:
  Waypoints(std::uint64_t seed, const ParkConfig& config)
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

/// Makes the path of a car through a park: from the centre to random waypoints, half of them
/// visited before and now reached from another side. The car steers realistically: its curvature is
/// limited by the turning circle, its change of curvature by the speed of the steering wheel.
DrivePath make_path(std::uint64_t seed, const ParkConfig& config) {
  DrivePath path({0.0, 0.0, 0.0}, config.speed_mps);
  Waypoints waypoints(seed, config);
  Eigen::Vector2d p = Eigen::Vector2d::Zero();
  Eigen::Vector2d goal = waypoints.next(p);
  const double lock_per_m = 1.0 / config.turn_radius_m;
  // A waypoint counts as reached within the turning circle; otherwise the car could circle around
  // it forever.
  const double reached_m = 2.0 * config.turn_radius_m;
  double curvature_per_m = 0.0;
  while (path.length_m() < config.way_m) {
    const Pose2 now = path.pose_at(path.duration_s());
    p = {now.x_m, now.y_m};
    if ((goal - p).norm() < reached_m) goal = waypoints.next(p);
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

constexpr double kLane_m = 2.0;      // half width of the clear lane along the path
constexpr double kGroup_m = 8.0;     // max distance to another tree of its group
constexpr double kBushSize_m = 1.6;  // width of the widest bush
constexpr int kNumPlaceTries = 200;

class ParkBuilder {
 public:
  ParkBuilder(std::uint64_t seed, const ParkConfig& config)
      : config_(config), place_(seed, Stream::kParkScene), appearance_(seed, Stream::kAppearance) {
    World& world = scene_.world;
    world.indoors = false;
    world.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    scene_.path = make_path(seed, config);
    const double end_s = scene_.path.duration_s();
    for (double t_s = 0.0; t_s <= end_s; t_s += 1.0 / config.speed_mps) {
      const Pose2 pose = scene_.path.pose_at(t_s);
      way_.insert(static_cast<int>(way_points_.size()), pose.x_m, pose.y_m);
      way_points_.emplace_back(pose.x_m, pose.y_m);
    }
  }

  Scene build() {
    for (int i = 0; i < config_.num_trees; ++i) add_tree();
    for (int i = 0; i < config_.num_bushes; ++i) add_bush();
    return std::move(scene_);
  }

 private:
  void add_tree() {
    // Uniform in the logarithm: many thin trunks, few thick ones.
    const double width_m =
        config_.trunk_width_min_m *
        std::pow(config_.trunk_width_max_m / config_.trunk_width_min_m, place_.uniform());
    const bool grouped = place_.uniform() < config_.clump_fraction;
    const auto p = find_place(0.5 * width_m, grouped);
    if (!p) return;
    Cylinder trunk{p->x(), p->y(), 0.5 * width_m, 3.0, 0.0, 0, {}};
    trunk.appearance.texture = Appearance::Texture::kRoughBark;
    trunk.appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    add_named('T', *p,
              [&](const std::string& name) { scene_.add(trunk, detection::Label::kTree, name); });
  }

  /// Adds a bush: an irregular cluster of twigs.
  void add_bush() {
    const double size_m = place_.uniform(0.3, 1.0) * kBushSize_m;
    const auto p = find_place(0.5 * size_m, false);
    if (!p) return;
    add_named('S', *p, [&](const std::string& name) {
      scene_.add_bush(p->x(), p->y(), size_m, {0.5, 1.6}, name, place_, [&] {
        Appearance leaves;
        leaves.texture = Appearance::Texture::kLeaves;
        leaves.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
        return leaves;
      });
    });
  }

  /// Names an object by its number in the truth, adds it and keeps its position clear.
  template <class Add>
  void add_named(char kind, const Eigen::Vector2d& p, Add add) {
    const std::size_t number = scene_.truth.size();
    add(kind + std::to_string(number + 1));
    trees_.insert(static_cast<int>(number), p);
  }

  /// Finds a position clear of the path and of all objects; none if the park is full.
  std::optional<Eigen::Vector2d> find_place(double radius_m, bool grouped) {
    for (int i = 0; i < kNumPlaceTries; ++i) {
      const double u = place_.uniform(), w = place_.uniform();
      Eigen::Vector2d p((u - 0.5) * config_.length_m, (w - 0.5) * config_.width_m);
      if (grouped && !scene_.truth.empty()) {
        const auto other =
            static_cast<std::size_t>(place_.uniform() * static_cast<double>(scene_.truth.size()));
        const double away_m = place_.uniform(config_.trees_apart_m, kGroup_m);
        const double angle_rad = 2.0 * geometry::kPi * u;
        p = {scene_.truth[other].x_m + away_m * std::cos(angle_rad),
             scene_.truth[other].y_m + away_m * std::sin(angle_rad)};
      }
      const double lane_m = kLane_m + radius_m;
      bool clear = true;
      for (const int s : way_.near(p, lane_m)) {
        clear &= (way_points_[static_cast<std::size_t>(s)] - p).norm() >= lane_m;
      }
      for (const int t : trees_.near(p, config_.trees_apart_m + radius_m + 1.0)) {
        const TruthObject& other = scene_.truth[static_cast<std::size_t>(t)];
        const double apart_m = std::hypot(other.x_m - p.x(), other.y_m - p.y());
        clear &= apart_m >= std::max(config_.trees_apart_m, radius_m + 0.5 * other.width_m + 0.3);
      }
      if (clear) return p;
    }
    return std::nullopt;
  }

  const ParkConfig& config_;
  Random place_;
  Random appearance_;
  Scene scene_;
  std::vector<Eigen::Vector2d> way_points_;
  geometry::PointGrid way_{4.0};
  geometry::PointGrid trees_{4.0};
};

}  // namespace

Scene make_park_scene(std::uint64_t seed, const ParkConfig& config) {
  return ParkBuilder(seed, config).build();
}

}  // namespace orchard::simulation
