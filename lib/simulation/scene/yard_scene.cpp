// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/scenes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

constexpr double kRowSpacing_m = 4.0;
constexpr double kTreeSpacing_m = 2.5;
constexpr int kRows = 6;  ///< along map y; the first aisle driven is map x = 0
constexpr int kTreesPerRow = 20;
constexpr double kBlockBegin_m = 10.0;
constexpr double kMissingFraction = 0.1;
constexpr double kTwigSpacing_m = 0.15;  ///< along a hedge
constexpr double kHedgeDepth_m = 0.5;    ///< beams end anywhere within it
constexpr double kHedgeSway_m = 0.03;
constexpr double kCurveRadius_m = 1.2;  ///< a metre of path turns half the view away
constexpr double kClear_m = 2.5;  ///< min distance of a scattered tree or a crate from the path

using Places = std::vector<Eigen::Vector2d>;

/// The corners of the path: aisles of the block up and down, and rings of several sizes around shed
/// and block, some driven in both directions.
Places corners() {
  return {// up the middle aisle, around the block's north, between block hedge and shed, home
          {0, 0},
          {0, 68},
          {30, 72},
          {30, 42},
          {58, 42},
          {97, 40},
          {97, 8},
          {40, 8},
          {16, -6},
          // up the aisle beside it, the large ring along the outer hedges
          {4, -4},
          {4, 66},
          {16, 78},
          {108, 78},
          {108, -10},
          {36, -10},
          {-15, -8},
          // outside the block, back down the middle, the shed the other way round
          {-15, 64},
          {-8, 66},
          {-8, -2},
          {0, -8},
          {38, 6},
          {92, 8},
          {94, 42},
          {60, 44},
          {28, 44},
          // north side again, the large ring from the other side, home
          {28, 74},
          {104, 76},
          {104, 48},
          {70, 46},
          {32, 46},
          {32, 10},
          {14, -4},
          {0, -4},
          // and the middle aisle once more
          {0, 68},
          {-16, 70},
          {-16, -8}};
}

/// Straight lines between corners, rounded by arcs.
DrivePath path_along(const Places& at, double speed_mps) {
  const auto heading = [&](std::size_t i) {
    const Eigen::Vector2d way = at[i + 1] - at[i];
    return std::atan2(way.y(), way.x());
  };
  DrivePath path({at[0].x(), at[0].y(), heading(0)}, speed_mps);
  double cut_m = 0.0;  // length cut from the straight line by the previous corner
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double length_m = (at[i + 1] - at[i]).norm();
    if (i + 2 == at.size()) {
      path.append(length_m - cut_m, 0.0);
      break;
    }
    const double turn_rad = geometry::wrap_angle_rad(heading(i + 1) - heading(i));
    const double next_m = (at[i + 2] - at[i + 1]).norm();
    const double half = std::tan(0.5 * std::abs(turn_rad));
    const double ahead_m = std::min({kCurveRadius_m * half, 0.45 * length_m, 0.45 * next_m});
    path.append(length_m - cut_m - ahead_m, 0.0);
    if (half > 1e-6) {
      const double radius_m = ahead_m / half;
      path.append(radius_m * std::abs(turn_rad), (turn_rad > 0.0 ? 1.0 : -1.0) / radius_m);
    }
    cut_m = half > 1e-6 ? ahead_m : 0.0;
  }
  return path;
}

class YardBuilder {
 public:
  YardBuilder(std::uint64_t seed, const YardConfig& config)
      : config_(config), place_(seed, Stream::kScene), appearance_(seed, Stream::kAppearance) {
    World& world = scene_.world;
    world.indoors = false;
    world.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    Places way = corners();
    // The corners outside the block differ from drive to drive.
    for (std::size_t i = 1; i < way.size(); ++i) {
      const bool in_block = std::abs(way[i].x()) < 13.0;
      const double most_m = in_block ? 0.3 : 1.5;
      way[i] += Eigen::Vector2d(place_.uniform(-most_m, most_m), place_.uniform(-most_m, most_m));
    }
    scene_.path = path_along(way, config.speed_mps);
    const double duration_s = scene_.path.duration_s();
    for (double s = 0.0; s <= duration_s; s += 1.0 / config.speed_mps) {
      const Pose2 pose = scene_.path.pose_at(s);
      driven_.emplace_back(pose.x_m, pose.y_m);
    }
  }

  Scene build() {
    add_block();
    add_shed();
    add_hedge({-24, -18}, {116, -18});
    add_hedge({116, -18}, {116, 86});
    add_hedge({116, 86}, {-24, 86});
    add_hedge({-24, 86}, {-24, -18});
    add_hedge({21, 16}, {21, 62});
    for (int i = 0; i < config_.num_trees; ++i) add_scattered_tree();
    return std::move(scene_);
  }

 private:
  void add_block() {
    for (int row = 0; row < kRows; ++row) {
      for (int i = 0; i < kTreesPerRow; ++i) {
        const bool missing = place_.uniform() < kMissingFraction;
        const double x_m = (row - 0.5 * (kRows - 1)) * kRowSpacing_m + jitter(0.12);
        const double y_m = kBlockBegin_m + i * kTreeSpacing_m + jitter(0.2);
        const double width_m = std::clamp(place_.normal(0.13, 0.015), 0.09, 0.19);
        if (!missing) add_tree(x_m, y_m, width_m);
      }
    }
  }

  void add_shed() {
    const double x_m = 64.0 + jitter(2.0), y_m = 25.0 + jitter(1.5);
    const double yaw_rad = jitter(0.12);
    const double length_m = place_.uniform(30.0, 38.0), width_m = place_.uniform(12.0, 16.0);
    add_box({x_m, y_m}, yaw_rad, {0.0, 0.0}, {length_m, width_m});
    // A lean-to, gate posts and objects along the walls.
    const double side_m = 0.5 * width_m;
    add_box({x_m, y_m}, yaw_rad, {place_.uniform(-9.0, 9.0), side_m + 1.5}, {6.0, 3.0});
    for (int i = 0; i < 10; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0;
      const double size_m = place_.uniform(0.4, 1.2);
      add_box({x_m, y_m}, yaw_rad,
              {place_.uniform(-0.45, 0.45) * length_m, side * (side_m + 0.5 * size_m)},
              {size_m * place_.uniform(1.0, 2.0), size_m});
    }
  }

  void add_box(const Eigen::Vector2d& origin, double yaw_rad, const Eigen::Vector2d& at,
               const Eigen::Vector2d& size) {
    const Eigen::Vector2d p = transform(Pose2{origin.x(), origin.y(), yaw_rad}, at);
    Box box{p.x(), p.y(), yaw_rad, size.x(), size.y(), 3.0, 0.0, -1, {}};
    box.appearance.texture = Appearance::Texture::kWood;
    scene_.world.boxes.push_back(box);
  }

  /// Adds a hedge: bunches of leaves along a line, with a rough face.
  void add_hedge(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    const double length_m = (to - from).norm();
    const Eigen::Vector2d along = (to - from) / length_m;
    const Eigen::Vector2d across(-along.y(), along.x());
    double face_m = 0.0;
    for (double s_m = 0.0; s_m < length_m; s_m += kTwigSpacing_m) {
      face_m = 0.7 * face_m + place_.normal(0.0, 0.7 * config_.hedge_roughness_m);
      const double depth_m = face_m + place_.uniform(-0.5, 0.5) * kHedgeDepth_m;
      const Eigen::Vector2d p = from + s_m * along + depth_m * across;
      Cylinder bunch{p.x(), p.y(), place_.uniform(0.04, 0.12), 1.8, 0.0, -1, {}};
      bunch.sway_m = kHedgeSway_m;
      bunch.appearance.texture = Appearance::Texture::kLeaves;
      bunch.appearance.hue_deg = 95.0;
      scene_.world.cylinders.push_back(bunch);
    }
  }

  void add_scattered_tree() {
    for (int attempt = 0; attempt < 200; ++attempt) {
      const Eigen::Vector2d p(place_.uniform(-22.0, 114.0), place_.uniform(-16.0, 84.0));
      const double width_m = place_.uniform(0.15, 0.8);
      const bool in_block = std::abs(p.x()) < 12.0 && p.y() > 6.0 && p.y() < 62.0;
      const bool in_shed = std::abs(p.x() - 64.0) < 24.0 && std::abs(p.y() - 25.0) < 14.0;
      const auto is_near = [&](const Eigen::Vector2d& q) { return (p - q).norm() < kClear_m; };
      if (in_block || in_shed || std::abs(p.x() - 21.0) < 2.0 ||
          std::any_of(driven_.begin(), driven_.end(), is_near) ||
          std::any_of(scene_.truth.begin(), scene_.truth.end(), [&](const TruthObject& t) {
            return is_near({t.x_m, t.y_m});
          })) {
        continue;
      }
      return add_tree(p.x(), p.y(), width_m);
    }
  }

  void add_tree(double x_m, double y_m, double width_m) {
    Cylinder trunk{x_m, y_m, 0.5 * width_m, 2.0, 0.0, 0, {}};
    trunk.appearance.texture = Appearance::Texture::kBark;
    scene_.add(trunk, detection::Label::kTree, "T" + std::to_string(scene_.world.num_targets + 1));
  }

  double jitter(double most) { return place_.uniform(-most, most); }

  const YardConfig& config_;
  Random place_;
  Random appearance_;
  Scene scene_;
  Places driven_;
};

}  // namespace

Scene make_yard_scene(std::uint64_t seed, const YardConfig& config) {
  return YardBuilder(seed, config).build();
}

}  // namespace orchard::simulation
