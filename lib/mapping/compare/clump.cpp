// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/clump.hpp"

#include "geometry/point_grid.hpp"

namespace orchard::mapping {
namespace {

constexpr int kNumOthersMin = 2;

}  // namespace

std::vector<char> in_clumps(const std::vector<Landmark>& landmarks, const ClumpConfig& config) {
  std::vector<Eigen::Vector2d> places;
  for (const Landmark& l : landmarks) {
    if (l.width_m > config.stake_m) places.push_back({l.x_m, l.y_m});
  }
  const geometry::IndexedPoints things(std::move(places));
  std::vector<char> result;
  for (const Landmark& l : landmarks) {
    const int itself = l.width_m > config.stake_m ? 1 : 0;
    const std::size_t num = things.within({l.x_m, l.y_m}, config.near_m).size();
    result.push_back(static_cast<int>(num) - itself >= kNumOthersMin ? 1 : 0);
  }
  return result;
}

}  // namespace orchard::mapping
