// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_members.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "geometry/point_grid.hpp"
#include "geometry/statistics.hpp"
#include "mapping/rows/row_chains.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Trees closer than this are in the same slot.
constexpr double kOnePlace_spacings = 0.3;
/// Tree spacing along the rows [m] in the presence of clutter. Stems, bushes and hedges only reduce
/// nearest-neighbour distances, so the upper quartile is used.
double spacing_amid_clutter_m(const geometry::IndexedPoints& points) {
  std::vector<double> distances_m;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (double reach_m = 2.0; reach_m < 200.0; reach_m *= 3.0) {
      const auto near = points.nearest_few(points[i], reach_m, 2);
      if (near.size() < 2) continue;
      const auto other = index_of(near[0]) == i ? near[1] : near[0];
      distances_m.push_back((points[index_of(other)] - points[i]).norm());
      break;
    }
  }
  return geometry::quantile(std::move(distances_m), 0.75);
}

}  // namespace

std::vector<double> row_strengths(const std::vector<const Landmark*>& trees) {
  std::vector<double> strengths;
  for (const Landmark* tree : trees) strengths.push_back(tree->probability * tree->roc_mean);
  const double half = 0.5 * geometry::median(strengths);
  for (double& s : strengths) s = half > 0.0 ? s / half : 1.0;
  return strengths;
}

std::vector<std::size_t> seed_trees(const std::vector<Vector2d>& p_map,
                                    const std::vector<double>& strengths) {
  std::vector<Vector2d> strong;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    if (strengths[i] >= 1.0) strong.push_back(p_map[i]);
  }
  const double reach_m =
      kOnePlace_spacings * spacing_amid_clutter_m(geometry::IndexedPoints(std::move(strong)));
  const geometry::IndexedPoints all(p_map);
  std::vector<std::size_t> by_strength(p_map.size());
  std::iota(by_strength.begin(), by_strength.end(), std::size_t{0});
  std::stable_sort(by_strength.begin(), by_strength.end(),
                   [&](std::size_t a, std::size_t b) { return strengths[a] > strengths[b]; });
  std::vector<char> stands(p_map.size(), 0);
  std::vector<std::size_t> seeds;
  for (const std::size_t i : by_strength) {
    if (strengths[i] < 1.0) break;
    const std::vector<std::int32_t> near = all.within(p_map[i], reach_m);
    if (std::any_of(near.begin(), near.end(),
                    [&](std::int32_t k) { return stands[index_of(k)]; })) {
      continue;
    }
    stands[i] = 1;
    seeds.push_back(i);
  }
  std::sort(seeds.begin(), seeds.end());
  return seeds;
}

}  // namespace orchard::mapping
