// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/local_deformation.hpp"

#include "geometry/statistics.hpp"

namespace orchard::mapping {

using Eigen::Vector2d;

std::vector<Vector2d> without_local_deformation(const geometry::IndexedPoints& a,
                                                const geometry::IndexedPoints& b,
                                                const MapAlignment& alignment) {
  constexpr std::size_t kNumNeighbours = 10, kNumPairsMin = 12;
  std::vector<Vector2d> places;
  for (const Vector2d& p : b.points()) places.push_back(transform(alignment.T_a_b, p));
  if (alignment.pairs.size() < kNumPairsMin) return places;
  std::vector<Vector2d> paired;
  for (const LandmarkPair& pair : alignment.pairs) {
    paired.push_back(a[static_cast<std::size_t>(pair.a)]);
  }
  const geometry::IndexedPoints around(std::move(paired));
  std::vector<Vector2d> result = places;
  for (std::size_t j = 0; j < places.size(); ++j) {
    std::vector<std::int32_t> near;
    for (double reach_m = 4.0; near.size() <= kNumNeighbours && reach_m <= 25.0; reach_m *= 1.8) {
      near = around.nearest_few(places[j], reach_m, kNumNeighbours + 1);
    }
    std::vector<double> x_m, y_m;
    for (const std::int32_t k : near) {
      const LandmarkPair& pair = alignment.pairs[static_cast<std::size_t>(k)];
      if (pair.b == static_cast<std::int32_t>(j)) continue;  // not corrected by its own residual
      x_m.push_back(pair.residual_m.x());
      y_m.push_back(pair.residual_m.y());
    }
    if (x_m.size() < kNumNeighbours / 2) continue;
    result[j] -= Vector2d(geometry::median(std::move(x_m)), geometry::median(std::move(y_m)));
  }
  return result;
}

}  // namespace orchard::mapping
