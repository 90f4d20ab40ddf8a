// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/point_grid.hpp"
#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Spatial index of a world's objects: the cost of a scan depends on the objects within range, not
/// on the size of the orchard.
class WorldIndex {
 public:
  WorldIndex() = default;
  explicit WorldIndex(const World& world);

  /// Indices in world.cylinders, ascending, of all that may reach into a circle.
  std::vector<std::size_t> cylinders_near(double x_m, double y_m, double radius_m) const;

  /// Indices in world.boxes, likewise.
  std::vector<std::size_t> boxes_near(double x_m, double y_m, double radius_m) const;

 private:
  /// Objects by their centre.
  struct Layer {
    geometry::PointGrid grid{8.0};
    double reach_m = 0.0;  ///< extent of the largest object

    void insert(double x_m, double y_m, double reach_m, std::size_t place);
    std::vector<std::size_t> near(double x_m, double y_m, double radius_m) const;
  };
  Layer cylinders_;
  Layer boxes_;
};

}  // namespace orchard::simulation
