// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/scenes.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "geometry/angles.hpp"
#include "geometry/camera_model.hpp"
#include "geometry/visibility.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

constexpr int kTubesPerRow = 6;
constexpr double kTubeWidth_m = 0.090;
constexpr double kWideWidth_m = 0.170;
constexpr double kExposed_m = 0.500;      ///< of 900 mm, section 3.4
constexpr double kAccurateRange_m = 4.0;  ///< up to which the scanner's class limit holds
constexpr int kMinPairs = 5;
constexpr int kMaxPairs = 8;

/// A circle as seen from a laser: bearing of its centre, half width, and range of its front.
struct Outline {
  double range_m;
  double bearing_rad;
  double half_rad;
};

Outline outline(const Pose2& T_map_laser, const Cylinder& c) {
  const geometry::Outline seen =
      geometry::outline_of(inverse_transform(T_map_laser, {c.x_m, c.y_m}), c.radius_m);
  return {seen.distance_m - c.radius_m, seen.bearing_rad, seen.half_rad};
}

bool in_view(const geometry::CameraModel& camera, const geometry::LaserToCamera& to_camera,
             const Outline& o) {
  // 0.7 degrees beside each edge, so that a window across the edge is in the picture, too.
  constexpr double kBeside_rad = 0.012;
  for (const double side : {-1.0, 1.0}) {
    const double bearing_rad = o.bearing_rad + side * (o.half_rad + kBeside_rad);
    const auto pixel = camera.project(
        to_camera({o.range_m * std::cos(bearing_rad), o.range_m * std::sin(bearing_rad), 0.0}));
    if (!pixel || !camera.in_image(*pixel)) return false;
  }
  return true;
}

bool hidden(const Outline& o, const Outline& other) {
  constexpr double kClear_rad = 0.006;
  return other.range_m < o.range_m &&
         std::abs(other.bearing_rad - o.bearing_rad) < o.half_rad + other.half_rad + kClear_rad;
}

class TubeSceneBuilder {
 public:
  TubeSceneBuilder(std::uint64_t seed, const RigConfig& rig)
      : rig_(rig), place_(seed, Stream::kScene), appearance_(seed, Stream::kAppearance) {
    scene_.stepped = true;
    scene_.stop_period_s = rig.simulation.tubes.step_period_s;
    World& world = scene_.world;
    world.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    world.light_azimuth_rad = appearance_.uniform(0.0, 2.0 * geometry::kPi);
    world.light_elevation_rad = appearance_.uniform(0.5, 1.0);
    world.ambient = appearance_.uniform(0.50, 0.65);
    tube_hue_deg_ = appearance_.uniform(26.0, 34.0);
  }

  Scene build() {
    add_stops();
    const Scene empty = scene_;
    constexpr int kTries = 20;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      scene_ = empty;
      add_rows();
      add_objects();
      if (faults() == 0) break;
    }
    return std::move(scene_);
  }

 private:
  void add_stops() {
    const TubesConfig& tubes = rig_.simulation.tubes;
    for (int i = 0; i < tubes.num_steps; ++i) {
      scene_.stops.push_back({0.0, i * tubes.step_m, geometry::kPi / 2.0});
    }
  }

  void add_rows() {
    const TubesConfig& tubes = rig_.simulation.tubes;
    for (int row = 0; row < 2; ++row) {
      const double side = row == 0 ? -1.0 : 1.0;
      for (int i = 0; i < kTubesPerRow; ++i) {
        Cylinder tube = make(kTubeWidth_m, cardboard());
        tube.x_m = side * tubes.row_spacing_m / 2.0 + jitter();
        tube.y_m = tubes.first_tube_m + i * tubes.tube_spacing_m + jitter();
        scene_.add(tube, detection::Label::kTree, "T" + std::to_string(row * kTubesPerRow + i + 1));
      }
    }
  }

  /// Allowed region of an object; `side` is -1 or 1.
  struct Place {
    double x_min_m, x_max_m;  ///< from the path, on its side
    double y_min_m, y_max_m;
    double side;
  };

  void add_objects() {
    const TubesConfig& tubes = rig_.simulation.tubes;
    const double row_x = tubes.row_spacing_m / 2.0;
    const double first_m = tubes.first_tube_m, spacing_m = tubes.tube_spacing_m;
    const double end_m = first_m + (kTubesPerRow - 1) * spacing_m;
    Appearance other = cardboard();
    other.hue_deg = appearance_.uniform() < 0.5 ? appearance_.uniform(200.0, 230.0)
                                                : appearance_.uniform(110.0, 150.0);
    other.saturation = appearance_.uniform(0.45, 0.65);
    const double side = appearance_.uniform() < 0.5 ? -1.0 : 1.0;

    // B1 is outside one row, B2 and B4 between the rows near start and end, B3 outside the other.
    const double out_min_m = row_x + 0.20, out_max_m = row_x + 0.50;
    place("B1", make(kWideWidth_m, cardboard()),
          {out_min_m, out_max_m, first_m + 0.3 * spacing_m, first_m + 2.5 * spacing_m, side});
    place("B2", make(kTubeWidth_m, other),
          {0.30, 0.50, first_m - 0.5 * spacing_m, first_m + 0.6 * spacing_m, side});
    place("B3", make(kWideWidth_m, cardboard()),
          {out_min_m, out_max_m, first_m + 2.0 * spacing_m, end_m + 0.5 * spacing_m, -side});
    place("B4", make(kWideWidth_m, cardboard()),
          {0.32, 0.50, end_m - 1.2 * spacing_m, end_m + 0.6 * spacing_m, -side});
  }

  /// Tries positions until all objects are observed often enough; keeps the best if none succeeds.
  void place(const std::string& name, Cylinder object, const Place& where) {
    constexpr int kTries = 400;
    const Scene before = scene_;
    Scene best;
    int best_faults = 0;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      scene_ = before;
      object.x_m = where.side * place_.uniform(where.x_min_m, where.x_max_m);
      object.y_m = place_.uniform(where.y_min_m, where.y_max_m);
      scene_.add(object, detection::Label::kObject, name);
      const int num_faults = faults();
      if (attempt == 0 || num_faults < best_faults) {
        best_faults = num_faults;
        best = scene_;
      }
      if (best_faults == 0) break;
    }
    scene_ = std::move(best);
  }

  /// Number of missing and excess pairs.
  int faults() const {
    int sum = 0;
    for (const int n : count_pairs(scene_, rig_, kAccurateRange_m)) {
      sum += std::max(0, kMinPairs - n) + std::max(0, n - kMaxPairs);
    }
    return sum;
  }

  Cylinder make(double width_m, const Appearance& appearance) {
    return {0.0, 0.0, width_m / 2.0, kExposed_m, 0.0, 0, appearance};
  }

  Appearance cardboard() {
    Appearance appearance = draw_appearance(appearance_, {-3.0, 3.0}, {0.38, 0.52}, {0.68, 0.82});
    appearance.hue_deg += tube_hue_deg_;
    appearance.texture_seed = static_cast<std::uint32_t>(appearance_.bits());
    return appearance;
  }

  double jitter() {
    const double most_m = rig_.simulation.tubes.jitter_m;
    return place_.uniform(-most_m, most_m);
  }

  const RigConfig& rig_;
  Random place_;
  Random appearance_;
  double tube_hue_deg_ = 30.0;
  Scene scene_;
};

}  // namespace

std::vector<int> count_pairs(const Scene& scene, const RigConfig& rig, double range_max_m) {
  const geometry::CameraModel camera(rig.camera.intrinsics);
  const geometry::LaserToCamera to_camera(rig.camera.extrinsics);
  const std::vector<Cylinder>& things = scene.world.cylinders;
  std::vector<int> counts(scene.truth.size(), 0);
  std::vector<Outline> outlines(things.size());
  for (const Pose2& T_map_base : scene.stops) {
    const Pose2 T_map_laser =
        compose(T_map_base, {rig.laser.mount_x_m, rig.laser.mount_y_m, rig.laser.mount_yaw_rad});
    for (std::size_t i = 0; i < things.size(); ++i) outlines[i] = outline(T_map_laser, things[i]);
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const Outline& o = outlines[i];
      if (o.range_m > range_max_m || !in_view(camera, to_camera, o)) continue;
      const bool clear = std::none_of(outlines.begin(), outlines.end(),
                                      [&o](const Outline& other) { return hidden(o, other); });
      if (clear) ++counts[i];
    }
  }
  return counts;
}

Scene make_tube_scene(std::uint64_t seed, const RigConfig& rig) {
  return TubeSceneBuilder(seed, rig).build();
}

}  // namespace orchard::simulation
