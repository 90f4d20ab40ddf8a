// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/park/park_scene.hpp"

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
#include "simulation/scene/park/park_path.hpp"

namespace orchard::simulation {
namespace {

constexpr double kLane_m = 2.0;          // half width of the clear lane along the path
constexpr double kGroup_m = 8.0;         // max distance to another tree of its group
constexpr double kBushSize_m = 1.6;      // width of the widest bush
constexpr double kTwigsPerMetre = 40.0;  // per metre of bush width
constexpr int kNumPlaceTries = 200;

class ParkBuilder {
 public:
  ParkBuilder(std::uint64_t seed, const ParkConfig& config)
      : config_(config), place_(seed, Stream::kParkScene), appearance_(seed, Stream::kAppearance) {
    World& world = scene_.world;
    world.indoors = false;
    world.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    scene_.path = make_park_path(seed, config);
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
    Cylinder trunk;
    trunk.x_m = p->x();
    trunk.y_m = p->y();
    trunk.radius_m = 0.5 * width_m;
    trunk.height_m = 3.0;
    trunk.target = scene_.world.num_targets++;
    trunk.appearance.texture = Appearance::Texture::kRoughBark;
    trunk.appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    const std::size_t number = scene_.truth.size();
    scene_.truth.push_back(
        {detection::Label::kTree, p->x(), p->y(), width_m, "T" + std::to_string(number + 1)});
    scene_.world.cylinders.push_back(trunk);
    trees_.insert(static_cast<int>(number), *p);
  }

  /// Adds a bush: an irregular cluster of twigs.
  void add_bush() {
    const double size_m = place_.uniform(0.3, 1.0) * kBushSize_m;
    const auto p = find_place(0.5 * size_m, false);
    if (!p) return;
    const int target = scene_.world.num_targets++;
    const int num_twigs = static_cast<int>(kTwigsPerMetre * size_m);
    for (int i = 0; i < num_twigs; ++i) {
      const double distance_m = 0.5 * size_m * std::sqrt(place_.uniform());
      const double angle_rad = place_.uniform(0.0, 2.0 * geometry::kPi);
      Cylinder twig;
      twig.x_m = p->x() + distance_m * std::cos(angle_rad);
      twig.y_m = p->y() + distance_m * std::sin(angle_rad);
      twig.radius_m = place_.uniform(0.012, 0.05);
      twig.height_m = place_.uniform(0.5, 1.6);
      twig.target = target;
      twig.appearance.texture = Appearance::Texture::kLeaves;
      twig.appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
      scene_.world.cylinders.push_back(twig);
    }
    scene_.truth.push_back({detection::Label::kObject, p->x(), p->y(), size_m,
                            "S" + std::to_string(scene_.truth.size() + 1)});
    trees_.insert(static_cast<int>(scene_.truth.size()) - 1, *p);
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
