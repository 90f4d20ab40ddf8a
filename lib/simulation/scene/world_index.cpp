// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/world_index.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::simulation {
namespace {

constexpr double kCell_m = 8.0;

std::int64_t cell_of(double value_m) {
  return static_cast<std::int64_t>(std::floor(value_m / kCell_m));
}

/// Cells of one row of the grid have neighbouring keys.
std::int64_t key_of(std::int64_t column, std::int64_t row) { return (row << 32) + column; }

}  // namespace

void WorldIndex::Layer::insert(double x_m, double y_m, double thing_reach_m, std::size_t place) {
  by_cell.emplace_back(key_of(cell_of(x_m), cell_of(y_m)), place);
  reach_m = std::max(reach_m, thing_reach_m);
}

std::vector<std::size_t> WorldIndex::Layer::near(double x_m, double y_m, double radius_m) const {
  const double r_m = radius_m + reach_m;
  std::vector<std::size_t> places;
  for (std::int64_t row = cell_of(y_m - r_m); row <= cell_of(y_m + r_m); ++row) {
    const std::int64_t last = key_of(cell_of(x_m + r_m), row);
    auto it = std::lower_bound(by_cell.begin(), by_cell.end(),
                               std::make_pair(key_of(cell_of(x_m - r_m), row), std::size_t{0}));
    for (; it != by_cell.end() && it->first <= last; ++it) places.push_back(it->second);
  }
  std::sort(places.begin(), places.end());
  return places;
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
  std::sort(cylinders_.by_cell.begin(), cylinders_.by_cell.end());
  std::sort(boxes_.by_cell.begin(), boxes_.by_cell.end());
}

std::vector<std::size_t> WorldIndex::cylinders_near(double x_m, double y_m, double radius_m) const {
  return cylinders_.near(x_m, y_m, radius_m);
}

std::vector<std::size_t> WorldIndex::boxes_near(double x_m, double y_m, double radius_m) const {
  return boxes_.near(x_m, y_m, radius_m);
}

}  // namespace orchard::simulation
