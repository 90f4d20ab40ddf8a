// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

class OrchardPathBuilder {
 public:
  OrchardPathBuilder(std::uint64_t seed, const OrchardConfig& config, const CarryConfig& carry)
      : seed_(seed),
        config_(config),
        carry_(carry),
        row_length_m_((config.trees_per_row - 1) * config.tree_spacing_m),
        num_aisles_(std::max(1, config.num_rows - 1)),
        path_({0.0, 0.0, geometry::kPi / 2.0}, config.speed_mps) {}

  DrivePath build() {
    // One lap more than needed, so that the drive can start anywhere on a lap.
    const int num_laps = std::max(1, config_.laps) + (config_.start_anywhere ? 1 : 0);
    for (int lap = 0; lap < num_laps; ++lap) {
      drive_aisles();
      if (config_.laps > 0) return_to_start();
    }
    double begin_m = 0.0;
    if (config_.start_anywhere) {
      const double lap_m = path_.length_m() / num_laps;
      begin_m = Random(seed_, Stream::kStart).uniform(0.0, lap_m);
      path_.drive_only(begin_m, begin_m + config_.laps * lap_m);
    }
    if (carry_.for_s > 0.0 && carry_.at_s > 0.0) carry_away(begin_m);
    return path_;
  }

 private:
  struct Aisle {
    double begin_m;
    double length_m;
    int number;  ///< from 0
  };

  double bottom_y_m() const { return kRowsBegin_m - config_.headland_m; }

  void drive_aisles() {
    const double straight_m = kRowsBegin_m + row_length_m_ + config_.headland_m;
    const double between_m = row_length_m_ + 2.0 * config_.headland_m;
    const double curvature = 2.0 / config_.row_spacing_m;  // half circles from aisle to aisle
    for (int aisle = 0; aisle < num_aisles_; ++aisle) {
      const double length_m = aisle == 0 ? straight_m : between_m;
      const double begin_m = path_.length_m();
      drive_aisle(length_m);
      aisles_.push_back({begin_m, path_.length_m() - begin_m, aisle});
      if (aisle + 1 < num_aisles_) {
        const double side = aisle % 2 == 0 ? -1.0 : 1.0;  // first to the right, towards +x
        path_.append(geometry::kPi / curvature, side * curvature);
      }
    }
  }

  /// Returns along the headland and, after an odd number of aisles, down the outer side of the
  /// first row.
  void return_to_start() {
    const double radius_m = 0.5 * config_.row_spacing_m;
    const double quarter_m = 0.5 * geometry::kPi * radius_m;
    const double last_x_m = (num_aisles_ - 1) * config_.row_spacing_m;
    const double turn_y_m = std::min(0.0, bottom_y_m());
    if (num_aisles_ % 2 == 1) {
      const double top_y_m = kRowsBegin_m + row_length_m_ + config_.headland_m;
      path_.append(quarter_m, 1.0 / radius_m);
      path_.append(last_x_m + config_.row_spacing_m - 2.0 * radius_m, 0.0);
      path_.append(quarter_m, 1.0 / radius_m);
      path_.append(top_y_m - turn_y_m, 0.0);
      path_.append(2.0 * quarter_m, 1.0 / radius_m);
    } else {
      path_.append(bottom_y_m() - turn_y_m, 0.0);
      path_.append(quarter_m, -1.0 / radius_m);
      path_.append(last_x_m - 2.0 * radius_m, 0.0);
      path_.append(quarter_m, -1.0 / radius_m);
    }
    path_.append(-turn_y_m, 0.0);
  }

  /// Appends a straight line, or a weaving path with yaw a sin(2 pi t / period) that ends at the
  /// same point.
  void drive_aisle(double length_m) {
    if (config_.weave_radps <= 0.0) return path_.append(length_m, 0.0);
    const double rate = 2.0 * geometry::kPi / config_.weave_period_s;
    const double most_rad = config_.weave_radps / rate;
    constexpr int kPieces = 32;  // of a period
    double cosines = 0.0;
    for (int i = 0; i < kPieces; ++i) {
      cosines += std::cos(most_rad * std::sin(2.0 * geometry::kPi * (i + 0.5) / kPieces));
    }
    const double wanted_m = config_.speed_mps * config_.weave_period_s;  // in a period
    const double forward = cosines / kPieces;
    const double num_periods = std::max(1.0, std::round(length_m / (wanted_m * forward)));
    const double piece_m = length_m / (num_periods * forward * kPieces);
    for (int i = 0; i < static_cast<int>(num_periods) * kPieces; ++i) {
      const double turn_rad = most_rad * (std::sin(2.0 * geometry::kPi * (i + 1) / kPieces) -
                                          std::sin(2.0 * geometry::kPi * i / kPieces));
      path_.append(piece_m, turn_rad / piece_m);
    }
  }

  /// Carries the robot to another aisle on the same lap, with most of that aisle still ahead.
  void carry_away(double begin_m) {
    const double lifted_m = path_.way_at(carry_.at_s);
    const int num_laps = static_cast<int>(aisles_.size()) / num_aisles_;
    const double lap_m = path_.length_m() / num_laps;
    const auto lap =
        static_cast<std::size_t>(std::clamp(static_cast<int>(lifted_m / lap_m), 0, num_laps - 1));
    Random random(seed_, Stream::kCarry);
    std::vector<Aisle> others;
    for (int i = 0; i < num_aisles_; ++i) {
      const Aisle& aisle = aisles_[lap * static_cast<std::size_t>(num_aisles_) + i];
      const bool here = lifted_m >= aisle.begin_m && lifted_m < aisle.begin_m + aisle.length_m;
      const bool wanted = carry_.to_aisle == 0 || carry_.to_aisle == aisle.number + 1;
      if (!here && wanted && aisle.begin_m > begin_m) others.push_back(aisle);
    }
    if (others.empty()) return;
    const auto chosen = static_cast<std::size_t>(random.uniform() * others.size());
    const Aisle& aisle = others[chosen];
    path_.carry(carry_.at_s, carry_.for_s,
                aisle.begin_m + random.uniform(0.1, 0.5) * aisle.length_m);
  }

  std::uint64_t seed_;
  const OrchardConfig& config_;
  const CarryConfig& carry_;
  double row_length_m_;
  int num_aisles_;
  DrivePath path_;
  std::vector<Aisle> aisles_;
};

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
  /// The first aisle is map x = 0.
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
        scene_.add(trunk, detection::Label::kTree, "T" + std::to_string(++num_trees_));
      }
    }
    if (config_.post_every_m <= 0.0) return;
    // Halfway between two tree positions, like real trellis posts.
    for (double y_m = 0.5 * config_.tree_spacing_m; y_m < row_length_m_;
         y_m += std::max(1.0, std::round(config_.post_every_m / config_.tree_spacing_m)) *
                config_.tree_spacing_m) {
      const bool wide = place_.uniform() < config_.wide_post_fraction;
      const double width_m = wide ? config_.trunk_width_m : config_.post_width_m;
      scene_.add({row_x_m(row), kRowsBegin_m + y_m, width_m / 2.0, 2.0, 0.0, 0, painted()},
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
      if (scene_.is_clear(x_m, y_m, 0.3 + 0.5 * size_m)) break;
    }
    scene_.add_bush(x_m, y_m, size_m, {0.35, 0.9}, "S" + std::to_string(++num_bushes_), place_,
                    [&] {
                      return seeded(draw_appearance(appearance_, {75.0, 115.0}, {0.35, 0.6},
                                                    {0.3, 0.55}, Appearance::Texture::kLeaves));
                    });
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

  Appearance bark() {
    return seeded(draw_appearance(
        appearance_, {config_.bark_hue_min_deg, config_.bark_hue_max_deg},
        {config_.bark_saturation_min, config_.bark_saturation_max},
        {config_.bark_value_min, config_.bark_value_max},
        config_.rough_bark ? Appearance::Texture::kRoughBark : Appearance::Texture::kBark));
  }

  Appearance painted() {
    return seeded(draw_appearance(appearance_, {200.0, 230.0}, {0.12, 0.30}, {0.70, 0.85}));
  }

  Appearance seeded(Appearance appearance) {
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

DrivePath make_orchard_path(std::uint64_t seed, const OrchardConfig& config,
                            const CarryConfig& carry) {
  return OrchardPathBuilder(seed, config, carry).build();
}

Scene make_orchard_scene(std::uint64_t seed, const OrchardConfig& config,
                         const CarryConfig& carry) {
  return OrchardSceneBuilder(seed, config, carry).build();
}

}  // namespace orchard::simulation
