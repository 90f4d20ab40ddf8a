// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "geometry/angles.hpp"
#include "simulation/random.hpp"
#include "simulation/scene/scenes.hpp"

namespace orchard::simulation {
namespace {

bool is_tree(const TruthObject& thing) { return thing.label == detection::Label::kTree; }

/// A branch that leaves a trunk near the height of the scan, as young trees are trained: at 30 to
/// 60 degrees above the horizon.
Cylinder low_branch(const Cylinder& trunk, double scan_m, Random& random) {
  Cylinder branch;
  const double length_m = random.uniform(0.3, 0.8);
  const double towards_rad = random.uniform(-geometry::kPi, geometry::kPi);
  const double up_rad = random.uniform(geometry::kPi / 6.0, geometry::kPi / 3.0);
  branch.radius_m = random.uniform(0.005, 0.012);
  branch.base_m = std::max(0.1, scan_m + random.uniform(-0.4, 0.4));
  branch.height_m = length_m * std::sin(up_rad);
  branch.lean_x = std::cos(towards_rad) / std::tan(up_rad);
  branch.lean_y = std::sin(towards_rad) / std::tan(up_rad);
  // It begins on the trunk's axis, and its place is that of its axis at the height of the scan.
  const double below_m = scan_m - branch.base_m;
  branch.x_m = trunk.x_m + below_m * (branch.lean_x - trunk.lean_x);
  branch.y_m = trunk.y_m + below_m * (branch.lean_y - trunk.lean_y);
  branch.target = -1;
  branch.appearance = trunk.appearance;
  branch.appearance.texture_seed = static_cast<std::uint32_t>(random.bits());
  return branch;
}

}  // namespace

void grow_low_branches(std::uint64_t seed, const SimulationConfig& config, Scene& scene) {
  const double mean = config.terrain.low_branches_per_tree;
  const std::size_t num_cylinders = scene.world.cylinders.size();
  for (std::size_t i = 0; i < num_cylinders; ++i) {
    Cylinder& trunk = scene.world.cylinders[i];
    if (trunk.target < 0 || !is_tree(scene.truth[static_cast<std::size_t>(trunk.target)])) continue;
    trunk.taper = 0.5 * config.terrain.trunk_taper;
    Random random(seed, Stream::kLowBranches, i);
    const int n = static_cast<int>(2.0 * mean * random.uniform() + 0.5);
    for (int k = 0; k < n; ++k) {
      const Cylinder stem = scene.world.cylinders[i];
      scene.world.cylinders.push_back(low_branch(stem, config.scanner.height_m, random));
    }
  }
}

void stand_on_terrain(const Terrain& terrain, Scene& scene) {
  for (TruthObject& thing : scene.truth) thing.z_m = terrain.height_m(thing.x_m, thing.y_m);
}

}  // namespace orchard::simulation
