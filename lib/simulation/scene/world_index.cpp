// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/world_index.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::simulation {

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

}  // namespace orchard::simulation
