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

/// True if anything in the scene moves.
bool has_motion(const Scene& scene);

/// The scene's world at a time of the run [s], with people, vehicles and swaying objects at their
/// current positions.
World world_at(const Scene& scene, double time_s);

/// The part of the world that may reach into a circle, for lasers: without crowns and light.
World world_near(const Scene& scene, const WorldIndex& index, double x_m, double y_m,
                 double radius_m, double time_s);

/// The scene's truth at a time of the run [s], with people and vehicles at their current positions.
std::vector<TruthObject> truth_at(const Scene& scene, double time_s);

}  // namespace orchard::simulation
