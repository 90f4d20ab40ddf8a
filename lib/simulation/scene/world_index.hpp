// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/point_grid.hpp"
#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Finds what stands near a place, so that a scan of a large orchard costs what is in its reach.
class WorldIndex {
 public:
  WorldIndex() = default;
  explicit WorldIndex(const World& world);

  /// Places in world.cylinders, ascending, of all that may reach into a circle.
  std::vector<std::size_t> cylinders_near(double x_m, double y_m, double radius_m) const;

  /// The same in world.boxes.
  std::vector<std::size_t> boxes_near(double x_m, double y_m, double radius_m) const;

 private:
  /// Things by their middle.
  struct Layer {
    geometry::PointGrid grid{8.0};
    double reach_m = 0.0;  ///< of the largest thing

    void insert(double x_m, double y_m, double reach_m, std::size_t place);
    std::vector<std::size_t> near(double x_m, double y_m, double radius_m) const;
  };
  Layer cylinders_;
  Layer boxes_;
};

}  // namespace orchard::simulation
