// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/orchard_scene.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/orchard_path.hpp"

namespace orchard::simulation {
namespace {

class OrchardSceneBuilder {
 public:
  OrchardSceneBuilder(std::uint64_t seed, const OrchardConfig& config, const CarryConfig& carry)
      : seed_(seed),
        config_(config),
        carry_(carry),
        place_(seed, Stream::kScene),
        appearance_(seed, Stream::kAppearance) {
    World& world = scene_.world;
    world.indoors = false;
    world.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    world.light_azimuth_rad = appearance_.uniform(0.0, 2.0 * geometry::kPi);
    world.light_elevation_rad = appearance_.uniform(0.5, 1.1);
    world.ambient = appearance_.uniform(0.45, 0.6);
    row_length_m_ = (config.trees_per_row - 1) * config.tree_spacing_m;
  }

  Scene build() {
    for (int row = 0; row < config_.num_rows; ++row) add_row(row);
    for (int i = 0; i < config_.num_bushes; ++i) add_bush();
    add_path();
    return std::move(scene_);
  }

 private:
  /// The first alley is map x = 0.
  double row_x_m(int row) const { return (row - 0.5) * config_.row_spacing_m; }

  void add_row(int row) {
    for (int i = 0; i < config_.trees_per_row; ++i) {
      const bool missing = place_.uniform() < config_.missing_fraction;
      const double x_m = row_x_m(row) + jitter(0.5);
      const double y_m = kRowsBegin_m + i * config_.tree_spacing_m + jitter(1.0);
      const double width_m =
          std::clamp(place_.normal(config_.trunk_width_m, config_.trunk_width_sd_m),
                     0.6 * config_.trunk_width_m, 1.5 * config_.trunk_width_m);
      if (missing) {
        scene_.gaps.push_back({detection::Label::kTree, x_m, y_m, width_m, ""});
      } else {
        Cylinder trunk{x_m, y_m, width_m / 2.0, 1.6, 0.0, 0, bark()};
        Random lean(seed_, Stream::kLean, static_cast<std::uint64_t>(num_trees_));
        trunk.lean_x = lean.normal(0.0, config_.lean_sd_rad);
        trunk.lean_y = lean.normal(0.0, config_.lean_sd_rad);
        add(trunk, detection::Label::kTree, "T" + std::to_string(++num_trees_));
      }
    }
    if (config_.post_every_m <= 0.0) return;
    // Halfway between two tree positions, like real trellis posts.
    for (double y_m = 0.5 * config_.tree_spacing_m; y_m < row_length_m_;
         y_m += std::max(1.0, std::round(config_.post_every_m / config_.tree_spacing_m)) *
                config_.tree_spacing_m) {
      const bool wide = place_.uniform() < config_.wide_post_fraction;
      const double width_m = wide ? config_.trunk_width_m : config_.post_width_m;
      add({row_x_m(row), kRowsBegin_m + y_m, width_m / 2.0, 2.0, 0.0, 0, painted()},
          detection::Label::kObject, "P" + std::to_string(++num_posts_));
    }
  }

  /// Adds a bush: an irregular cluster of twigs in a row, away from trees and posts.
  void add_bush() {
    double x_m = 0.0, y_m = 0.0;
    const double size_m = place_.uniform(0.4, 0.8);
    for (int attempt = 0; attempt < 200; ++attempt) {
      const int row = static_cast<int>(place_.uniform() * config_.num_rows);
      x_m = row_x_m(row) + place_.uniform(-0.2, 0.2);
      y_m = kRowsBegin_m + place_.uniform(0.0, std::max(1.0, row_length_m_));
      const bool clear =
          std::none_of(scene_.truth.begin(), scene_.truth.end(), [&](const TruthObject& other) {
            return std::hypot(other.x_m - x_m, other.y_m - y_m) <
                   0.3 + 0.5 * size_m + 0.5 * other.width_m;
          });
      if (clear) break;
    }
    const int target = scene_.world.num_targets++;
    const int num_twigs = static_cast<int>(40 * size_m);
    for (int i = 0; i < num_twigs; ++i) {
      const double distance_m = 0.5 * size_m * std::sqrt(place_.uniform());
      const double angle_rad = place_.uniform(0.0, 2.0 * geometry::kPi);
      Cylinder twig;
      twig.x_m = x_m + distance_m * std::cos(angle_rad);
      twig.y_m = y_m + distance_m * std::sin(angle_rad);
      twig.radius_m = place_.uniform(0.012, 0.05);
      twig.height_m = place_.uniform(0.35, 0.9);
      twig.target = target;
      twig.appearance.hue_deg = appearance_.uniform(75.0, 115.0);
      twig.appearance.saturation = appearance_.uniform(0.35, 0.6);
      twig.appearance.value = appearance_.uniform(0.3, 0.55);
      twig.appearance.texture = Appearance::Texture::kLeaves;
      twig.appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
      scene_.world.cylinders.push_back(twig);
    }
    scene_.truth.push_back(
        {detection::Label::kObject, x_m, y_m, size_m, "S" + std::to_string(++num_bushes_)});
  }

  void add_path() {
    scene_.path = make_orchard_path(seed_, config_, carry_);
    if (config_.stop_every_m <= 0.0) return;
    scene_.stepped = true;
    scene_.stop_period_s = config_.stop_every_m / config_.speed_mps;  // time between stops
    const double way_m = scene_.path.duration_s() * config_.speed_mps;
    for (double s_m = 0.0; s_m <= way_m; s_m += config_.stop_every_m) {
      scene_.stops.push_back(scene_.path.pose_at(s_m / config_.speed_mps));
    }
  }

  void add(Cylinder cylinder, detection::Label label, const std::string& name) {
    cylinder.target = scene_.world.num_targets++;
    scene_.truth.push_back({label, cylinder.x_m, cylinder.y_m, 2.0 * cylinder.radius_m, name});
    scene_.world.cylinders.push_back(cylinder);
  }

  Appearance bark() {
    Appearance appearance;
    appearance.hue_deg = appearance_.uniform(config_.bark_hue_min_deg, config_.bark_hue_max_deg);
    appearance.saturation =
        appearance_.uniform(config_.bark_saturation_min, config_.bark_saturation_max);
    appearance.value = appearance_.uniform(config_.bark_value_min, config_.bark_value_max);
    appearance.texture =
        config_.rough_bark ? Appearance::Texture::kRoughBark : Appearance::Texture::kBark;
    appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    return appearance;
  }

  Appearance painted() {
    Appearance appearance;
    appearance.hue_deg = appearance_.uniform(200.0, 230.0);
    appearance.saturation = appearance_.uniform(0.12, 0.30);
    appearance.value = appearance_.uniform(0.70, 0.85);
    appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    return appearance;
  }

  double jitter(double fraction) {
    return place_.uniform(-config_.jitter_m, config_.jitter_m) * fraction;
  }

  std::uint64_t seed_;
  const OrchardConfig& config_;
  const CarryConfig& carry_;
  Random place_;
  Random appearance_;
  Scene scene_;
  double row_length_m_ = 0.0;
  int num_trees_ = 0;
  int num_posts_ = 0;
  int num_bushes_ = 0;
};

}  // namespace

Scene make_orchard_scene(std::uint64_t seed, const OrchardConfig& config,
                         const CarryConfig& carry) {
  return OrchardSceneBuilder(seed, config, carry).build();
}

}  // namespace orchard::simulation
