// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/moving_world.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"

namespace orchard::simulation {
namespace {

// An adult in trousers; stride and step width from gait studies at 1.3 m/s.
constexpr double kStride_m = 1.4;     ///< two steps
constexpr double kLegSwing_m = 0.28;  ///< of a knee before and behind the hips
constexpr double kLegApart_m = 0.18;
constexpr double kLegRadius_m = 0.065;
constexpr double kHip_m = 0.85;

// A narrow orchard tractor.
constexpr double kAxlesApart_m = 1.4;
constexpr double kTrack_m = 0.9;  ///< between the wheel centres of an axle
constexpr double kWheel_m = 0.65;
constexpr double kTyre_m = 0.22;
constexpr double kStart_mps2 = 1.0;

/// Distance gone, and the speed.
struct Way {
  double way_m = 0.0;
  double speed_mps = 0.0;
};

/// A person walks at once, a vehicle gathers speed.
Way way_of(const Mover& mover, double time_s) {
  const double gone_s = std::max(0.0, time_s - mover.starts_s);
  if (mover.kind == Mover::Kind::kPerson) {
    return {mover.speed_mps * gone_s, time_s < mover.starts_s ? 0.0 : mover.speed_mps};
  }
  const double started_s = std::min(gone_s, mover.speed_mps / kStart_mps2);
  return {0.5 * kStart_mps2 * started_s * started_s + mover.speed_mps * (gone_s - started_s),
          kStart_mps2 * started_s};
}

/// Axes of a mover that is `way_m` from its start.
Pose2 place_of(const Mover& mover, double way_m) {
  return {mover.x_m + way_m * std::cos(mover.heading_rad),
          mover.y_m + way_m * std::sin(mover.heading_rad), mover.heading_rad};
}

void add_person(const Mover& person, double time_s, World& world) {
  const Way way = way_of(person, time_s);
  const Pose2 place = place_of(person, way.way_m);
  const double c = std::cos(person.heading_rad), s = std::sin(person.heading_rad);
  const auto add = [&](const Eigen::Vector2d& p, double radius_m, double base_m, double top_m,
                       const Appearance& looks, double speed_mps) {
    Cylinder part{p.x(), p.y(), radius_m, top_m - base_m, base_m, person.target, looks};
    part.velocity_x_mps = c * speed_mps;
    part.velocity_y_mps = s * speed_mps;
    world.cylinders.push_back(part);
  };
  const double step_rad = 2.0 * geometry::kPi * way.way_m / kStride_m;
  const double rate_radps = 2.0 * geometry::kPi * way.speed_mps / kStride_m;
  for (const double side : {-1.0, 1.0}) {
    const double swing_m = way.speed_mps > 0.0 ? side * kLegSwing_m : 0.0;
    add(transform(place, {swing_m * std::sin(step_rad), side * 0.5 * kLegApart_m}), kLegRadius_m,
        0.0, kHip_m, person.clothes, way.speed_mps + swing_m * rate_radps * std::cos(step_rad));
  }
  Appearance coat = person.clothes, skin = person.clothes;
  coat.hue_deg = std::fmod(coat.hue_deg + 140.0, 360.0);
  skin.hue_deg = 20.0;
  skin.saturation = 0.35;
  skin.value = 0.6;
  add(place.translation_m(), 0.19, kHip_m, 1.45, coat, way.speed_mps);
  add(place.translation_m(), 0.095, 1.48, 1.73, skin, way.speed_mps);
}

void add_vehicle(const Mover& vehicle, double time_s, World& world) {
  const Pose2 place = place_of(vehicle, way_of(vehicle, time_s).way_m);
  const auto add = [&](double ahead_m, double beside_m, double length_m, double width_m,
                       double height_m, double base_m, const Appearance& paint) {
    const Eigen::Vector2d p = transform(place, {ahead_m, beside_m});
    world.boxes.push_back({p.x(), p.y(), vehicle.heading_rad, length_m, width_m, height_m, base_m,
                           vehicle.target, paint});
  };
  for (const double ahead_m : {-0.5 * kAxlesApart_m, 0.5 * kAxlesApart_m}) {
    for (const double beside_m : {-0.5 * kTrack_m, 0.5 * kTrack_m}) {
      add(ahead_m, beside_m, kWheel_m, kTyre_m, kWheel_m, 0.0, {30.0, 0.1, 0.15});
    }
  }
  add(0.0, 0.0, kAxlesApart_m + kWheel_m, kTrack_m, 0.6, kWheel_m, {120.0, 0.7, 0.5});
}

void add_movers(const Scene& scene, double time_s, World& world) {
  for (const Mover& mover : scene.movers) {
    (mover.kind == Mover::Kind::kPerson ? add_person : add_vehicle)(mover, time_s, world);
  }
}

/// Moves the `i`-th cylinder of a scene to its swaying position.
void sway(Cylinder& cylinder, std::size_t i, double time_s) {
  if (cylinder.sway_m <= 0.0) return;
  // Each sways at its own rate between 0.4 and 1.6 Hz.
  const std::uint64_t bits = mix_bits(cylinder.appearance.texture_seed + 0x51ed270bull * i);
  const double rate_hz = 0.4 + 1.2 * static_cast<double>(bits & 0xffff) / 65536.0;
  const double phase = static_cast<double>((bits >> 16) & 0xffff) / 65536.0;
  const double other_phase = static_cast<double>((bits >> 32) & 0xffff) / 65536.0;
  const double turns = rate_hz * time_s;
  cylinder.x_m += cylinder.sway_m * std::sin(2.0 * geometry::kPi * (turns + phase));
  cylinder.y_m += cylinder.sway_m * std::sin(2.0 * geometry::kPi * (turns + other_phase));
}

}  // namespace

void WorldIndex::Layer::insert(double x_m, double y_m, double thing_reach_m, std::size_t place) {
  grid.insert(static_cast<std::int32_t>(place), x_m, y_m);
  reach_m = std::max(reach_m, thing_reach_m);
}

std::vector<std::size_t> WorldIndex::Layer::near(double x_m, double y_m, double radius_m) const {
  const std::vector<std::int32_t> found = grid.near({x_m, y_m}, radius_m + reach_m);
  return {found.begin(), found.end()};
}

WorldIndex::WorldIndex(const World& world) {
  for (std::size_t i = 0; i < world.cylinders.size(); ++i) {
    const Cylinder& c = world.cylinders[i];
    cylinders_.insert(c.x_m, c.y_m, c.radius_m + c.sway_m, i);
  }
  for (std::size_t i = 0; i < world.boxes.size(); ++i) {
    const Box& b = world.boxes[i];
    boxes_.insert(b.x_m, b.y_m, 0.5 * std::hypot(b.length_m, b.width_m), i);
  }
}

std::vector<std::size_t> WorldIndex::cylinders_near(double x_m, double y_m, double radius_m) const {
  return cylinders_.near(x_m, y_m, radius_m);
}

std::vector<std::size_t> WorldIndex::boxes_near(double x_m, double y_m, double radius_m) const {
  return boxes_.near(x_m, y_m, radius_m);
}

bool has_motion(const Scene& scene) {
  return !scene.movers.empty() ||
         std::any_of(scene.world.cylinders.begin(), scene.world.cylinders.end(),
                     [](const Cylinder& c) { return c.sway_m > 0.0; });
}

World world_at(const Scene& scene, double time_s) {
  World world = scene.world;
  for (std::size_t i = 0; i < world.cylinders.size(); ++i) sway(world.cylinders[i], i, time_s);
  add_movers(scene, time_s, world);
  return world;
}

World world_near(const Scene& scene, const WorldIndex& index, double x_m, double y_m,
                 double radius_m, double time_s) {
  World world;
  world.num_targets = scene.world.num_targets;
  for (const std::size_t i : index.cylinders_near(x_m, y_m, radius_m)) {
    world.cylinders.push_back(scene.world.cylinders[i]);
    sway(world.cylinders.back(), i, time_s);
  }
  for (const std::size_t i : index.boxes_near(x_m, y_m, radius_m)) {
    world.boxes.push_back(scene.world.boxes[i]);
  }
  add_movers(scene, time_s, world);
  return world;
}

std::vector<TruthObject> truth_at(const Scene& scene, double time_s) {
  std::vector<TruthObject> truth = scene.truth;
  for (const Mover& mover : scene.movers) {
    TruthObject& thing = truth[static_cast<std::size_t>(mover.target)];
    const Way way = way_of(mover, time_s);
    const Pose2 place = place_of(mover, way.way_m);
    thing.x_m = place.x_m;
    thing.y_m = place.y_m;
    thing.velocity_x_mps = way.speed_mps * std::cos(mover.heading_rad);
    thing.velocity_y_mps = way.speed_mps * std::sin(mover.heading_rad);
  }
  return truth;
}

}  // namespace orchard::simulation
