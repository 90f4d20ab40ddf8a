// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/rows/row_order.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/point_grid.hpp"

namespace orchard::mapping {
namespace {

using Eigen::Vector2d;

/// Sum and number of the distances to the right from one chain's trees to another chain.
struct Beside {
  double sum_m = 0.0;
  int count = 0;
};

/// Per pair of chains: distances from the trees of one to their nearest tree to the right, if that
/// is in the other.
std::map<std::pair<int, int>, Beside> neighbours_to_the_right(const std::vector<Vector2d>& p_map,
                                                              const RowDirections& rows,
                                                              const std::vector<int>& chain_of) {
  const double reach_m = 6.0 * rows.spacing_m;
  const geometry::IndexedPoints points(p_map);
  std::map<std::pair<int, int>, Beside> beside;
  for (std::size_t i = 0; i < p_map.size(); ++i) {
    if (chain_of[i] < 0) continue;
    const Vector2d u = rows.directions[i];
    double nearest_m = reach_m;
    int nearest_chain = -1;
    points.near(p_map[i], std::hypot(reach_m, rows.spacing_m), [&](std::int32_t j) {
      const auto k = static_cast<std::size_t>(j);
      if (chain_of[k] < 0 || chain_of[k] == chain_of[i]) return;
      const Vector2d d = p_map[k] - p_map[i];
      const double right_m = u.y() * d.x() - u.x() * d.y();
      if (right_m <= 0.0 || std::abs(u.dot(d)) > rows.spacing_m) return;
      if (right_m < nearest_m || (right_m == nearest_m && chain_of[k] < nearest_chain)) {
        nearest_m = right_m;
        nearest_chain = chain_of[k];
      }
    });
    if (nearest_chain < 0) continue;
    Beside& b = beside[{chain_of[i], nearest_chain}];
    b.sum_m += nearest_m;
    ++b.count;
  }
  return beside;
}

}  // namespace

void order_from_left(const std::vector<Vector2d>& p_map, const RowDirections& rows,
                     std::vector<RowChain>& chains) {
  std::vector<int> chain_of(p_map.size(), -1);
  Vector2d forward(0.0, 0.0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (const std::int32_t i : chains[c]) {
      chain_of[static_cast<std::size_t>(i)] = static_cast<int>(c);
      forward += rows.directions[static_cast<std::size_t>(i)];
    }
  }
  forward.normalize();
  const Vector2d right(forward.y(), -forward.x());

  std::vector<double> centre_m(chains.size(), 0.0);
  for (std::size_t c = 0; c < chains.size(); ++c) {
    for (const std::int32_t i : chains[c]) {
      centre_m[c] +=
          right.dot(p_map[static_cast<std::size_t>(i)]) / static_cast<double>(chains[c].size());
    }
  }
  std::vector<std::size_t> by_centre(chains.size());
  std::iota(by_centre.begin(), by_centre.end(), std::size_t{0});
  std::sort(by_centre.begin(), by_centre.end(), [&](std::size_t a, std::size_t b) {
    return std::make_pair(centre_m[a], a) < std::make_pair(centre_m[b], b);
  });

  std::vector<std::vector<std::pair<std::size_t, double>>> edges(chains.size());
  for (const auto& [pair, beside] : neighbours_to_the_right(p_map, rows, chain_of)) {
    // A single tree that sees past the end of a row is no adjacency.
    if (beside.count < 2) continue;
    const auto a = static_cast<std::size_t>(pair.first), b = static_cast<std::size_t>(pair.second);
    edges[a].push_back({b, beside.sum_m / beside.count});
    edges[b].push_back({a, -beside.sum_m / beside.count});
  }
  // Lateral coordinate of each row, accumulated from the leftmost row of its group.
  std::vector<double> across_m(chains.size(), 0.0);
  std::vector<bool> reached(chains.size(), false);
  for (const std::size_t start : by_centre) {
    if (reached[start]) continue;
    reached[start] = true;
    across_m[start] = centre_m[start];
    std::vector<std::size_t> queue{start};
    for (std::size_t k = 0; k < queue.size(); ++k) {
      for (const auto& [to, step_m] : edges[queue[k]]) {
        if (reached[to]) continue;
        reached[to] = true;
        across_m[to] = across_m[queue[k]] + step_m;
        queue.push_back(to);
      }
    }
  }
  std::vector<std::size_t> order(by_centre);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return across_m[a] < across_m[b]; });
  std::vector<RowChain> sorted;
  for (const std::size_t c : order) sorted.push_back(std::move(chains[c]));
  chains = std::move(sorted);
}

}  // namespace orchard::mapping
