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

Cylinder part(double x_m, double y_m, double radius_m, double base_m, double top_m,
              const Person& person) {
  Cylinder cylinder;
  cylinder.x_m = x_m;
  cylinder.y_m = y_m;
  cylinder.radius_m = radius_m;
  cylinder.base_m = base_m;
  cylinder.height_m = top_m - base_m;
  cylinder.target = person.target;
  cylinder.appearance = person.clothes;
  return cylinder;
}

void add_person(const Person& person, double time_s, World& world) {
  const double c = std::cos(person.heading_rad), s = std::sin(person.heading_rad);
  const double walked_s = std::max(0.0, time_s - person.starts_s);
  const double now_mps = time_s < person.starts_s ? 0.0 : person.speed_mps;
  const double x_m = person.x_m + c * person.speed_mps * walked_s;
  const double y_m = person.y_m + s * person.speed_mps * walked_s;
  const double rate_radps = 2.0 * geometry::kPi * now_mps / kStride_m;
  for (const double side : {-1.0, 1.0}) {
    const double ahead_m = side * kLegSwing_m * std::sin(rate_radps * walked_s);
    const double beside_m = side * 0.5 * kLegApart_m;
    Cylinder leg = part(x_m + c * ahead_m - s * beside_m, y_m + s * ahead_m + c * beside_m,
                        kLegRadius_m, 0.0, kHip_m, person);
    const double speed_mps =
        now_mps + side * kLegSwing_m * rate_radps * std::cos(rate_radps * walked_s);
    leg.velocity_x_mps = c * speed_mps;
    leg.velocity_y_mps = s * speed_mps;
    world.cylinders.push_back(leg);
  }
  Cylinder body = part(x_m, y_m, 0.19, kHip_m, 1.45, person);
  body.appearance.hue_deg = std::fmod(body.appearance.hue_deg + 140.0, 360.0);
  Cylinder head = part(x_m, y_m, 0.095, 1.48, 1.73, person);
  head.appearance.hue_deg = 20.0;
  head.appearance.saturation = 0.35;
  head.appearance.value = 0.6;
  for (Cylinder* upper : {&body, &head}) {
    upper->velocity_x_mps = c * now_mps;
    upper->velocity_y_mps = s * now_mps;
    world.cylinders.push_back(*upper);
  }
}

/// Distance driven by a vehicle, and its speed.
struct Way {
  double way_m = 0.0;
  double speed_mps = 0.0;
};

Way way_of(const Vehicle& vehicle, double time_s) {
  const double driven_s = std::max(0.0, time_s - vehicle.leaves_s);
  const double started_s = std::min(driven_s, vehicle.speed_mps / kStart_mps2);
  return {0.5 * kStart_mps2 * started_s * started_s + vehicle.speed_mps * (driven_s - started_s),
          kStart_mps2 * started_s};
}

void add_vehicle(const Vehicle& vehicle, double time_s, World& world) {
  const double c = std::cos(vehicle.heading_rad), s = std::sin(vehicle.heading_rad);
  const double way_m = way_of(vehicle, time_s).way_m;
  Box box;
  box.yaw_rad = vehicle.heading_rad;
  box.target = vehicle.target;
  const auto add = [&](double ahead_m, double beside_m) {
    box.x_m = vehicle.x_m + c * (way_m + ahead_m) - s * beside_m;
    box.y_m = vehicle.y_m + s * (way_m + ahead_m) + c * beside_m;
    world.boxes.push_back(box);
  };
  box.length_m = kWheel_m;
  box.width_m = kTyre_m;
  box.height_m = kWheel_m;
  box.appearance.saturation = 0.1;
  box.appearance.value = 0.15;
  for (const double ahead_m : {-0.5 * kAxlesApart_m, 0.5 * kAxlesApart_m}) {
    for (const double beside_m : {-0.5 * kTrack_m, 0.5 * kTrack_m}) add(ahead_m, beside_m);
  }
  box.length_m = kAxlesApart_m + kWheel_m;
  box.width_m = kTrack_m;
  box.base_m = kWheel_m;
  box.height_m = 0.6;
  box.appearance.hue_deg = 120.0;
  box.appearance.saturation = 0.7;
  box.appearance.value = 0.5;
  add(0.0, 0.0);
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
  return !scene.people.empty() || !scene.vehicles.empty() ||
         std::any_of(scene.world.cylinders.begin(), scene.world.cylinders.end(),
                     [](const Cylinder& c) { return c.sway_m > 0.0; });
}

World world_at(const Scene& scene, double time_s) {
  World world = scene.world;
  for (std::size_t i = 0; i < world.cylinders.size(); ++i) sway(world.cylinders[i], i, time_s);
  for (const Person& person : scene.people) add_person(person, time_s, world);
  for (const Vehicle& vehicle : scene.vehicles) add_vehicle(vehicle, time_s, world);
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
  for (const Person& person : scene.people) add_person(person, time_s, world);
  for (const Vehicle& vehicle : scene.vehicles) add_vehicle(vehicle, time_s, world);
  return world;
}

std::vector<TruthObject> truth_at(const Scene& scene, double time_s) {
  std::vector<TruthObject> truth = scene.truth;
  for (const Person& person : scene.people) {
    TruthObject& thing = truth[static_cast<std::size_t>(person.target)];
    const double walked_s = std::max(0.0, time_s - person.starts_s);
    const double speed_mps = time_s < person.starts_s ? 0.0 : person.speed_mps;
    thing.velocity_x_mps = speed_mps * std::cos(person.heading_rad);
    thing.velocity_y_mps = speed_mps * std::sin(person.heading_rad);
    thing.x_m = person.x_m + person.speed_mps * walked_s * std::cos(person.heading_rad);
    thing.y_m = person.y_m + person.speed_mps * walked_s * std::sin(person.heading_rad);
  }
  for (const Vehicle& vehicle : scene.vehicles) {
    TruthObject& thing = truth[static_cast<std::size_t>(vehicle.target)];
    const Way way = way_of(vehicle, time_s);
    const double c = std::cos(vehicle.heading_rad), s = std::sin(vehicle.heading_rad);
    thing.velocity_x_mps = c * way.speed_mps;
    thing.velocity_y_mps = s * way.speed_mps;
    thing.x_m = vehicle.x_m + c * way.way_m;
    thing.y_m = vehicle.y_m + s * way.way_m;
  }
  return truth;
}

}  // namespace orchard::simulation
