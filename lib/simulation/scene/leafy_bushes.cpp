// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scene/leafy_bushes.hpp"

#include <utility>
#include <vector>

namespace orchard::simulation {

void make_bushes_leafy(double depth_m, Scene& scene) {
  std::vector<Cylinder> kept;
  std::vector<char> is_made(scene.truth.size(), 0);
  for (Cylinder c : scene.world.cylinders) {
    const auto target = static_cast<std::size_t>(c.target);
    const bool is_bush = c.target >= 0 && scene.truth[target].name[0] == 'S';
    if (is_bush && is_made[target]) continue;
    if (is_bush) {
      is_made[target] = 1;
      c.x_m = scene.truth[target].x_m;
      c.y_m = scene.truth[target].y_m;
      c.radius_m = 0.5 * scene.truth[target].width_m;
      c.leaf_depth_m = depth_m;
    }
    kept.push_back(c);
  }
  scene.world.cylinders = std::move(kept);
}

}  // namespace orchard::simulation
