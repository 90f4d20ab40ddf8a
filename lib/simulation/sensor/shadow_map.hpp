// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simulation/scene/scene.hpp"

namespace orchard::simulation {

/// Shadow map of a static world.
///
/// A grid over the ground: each cell stands for the line from it towards the sun, and stores the
/// fraction that crowns leave open and the height up to which a solid object blocks it. Swaying and
/// moving objects cast no shadow.
class ShadowMap {
 public:
  ShadowMap() = default;
  ShadowMap(const World& world, double sun_azimuth_rad, double sun_elevation_rad);

  /// Fraction of the sun that reaches a point of the map, [0, 1]. `target` casts no shadow on
  /// itself.
  float open(float x_m, float y_m, float z_m, int target) const;

  bool empty() const { return cells_.empty(); }

 private:
  struct Cell {
    float crown = 1.0f;  ///< fraction that crowns leave open
    float top_m = -1.0f;
    int target = -2;
  };

  void add(const Cylinder& cylinder);
  void add(const Box& box);
  void add(const Crown& crown);
  /// Adds the shadow of one upright line.
  void add_line(double x_m, double y_m, double base_m, double top_m, int target);
  Cell* at(double x_m, double y_m);

  double x_min_m_ = 0.0, y_min_m_ = 0.0;
  int num_x_ = 0, num_y_ = 0;
  double towards_x_ = 1.0, towards_y_ = 0.0;  ///< the sun's direction in the plane
  double cotangent_ = 1.0;                    ///< ratio of shadow length to height
  double sine_ = 1.0;
  std::vector<Cell> cells_;
};

}  // namespace orchard::simulation
