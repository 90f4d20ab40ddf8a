// SPDX-License-Identifier: BSD-3-Clause
#include "pose/slam/landmark_index.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

constexpr double kCell_m = 4.0;

std::int32_t cell(double coordinate_m) {
  // the clamp keeps the cast defined whatever comes
  return static_cast<std::int32_t>(std::clamp(std::floor(coordinate_m / kCell_m), -1e9, 1e9));
}

std::uint64_t key(std::int32_t x, std::int32_t y) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) |
         static_cast<std::uint32_t>(y);
}

}  // namespace

void SlamLandmarkIndex::insert(int landmark, const Eigen::Vector2d& p_map) {
  cells_[key(cell(p_map.x()), cell(p_map.y()))].push_back(landmark);
}

std::vector<int> SlamLandmarkIndex::near(const Eigen::Vector2d& p_map, double radius_m) const {
  std::vector<int> found;
  for (std::int32_t x = cell(p_map.x() - radius_m); x <= cell(p_map.x() + radius_m); ++x) {
    for (std::int32_t y = cell(p_map.y() - radius_m); y <= cell(p_map.y() + radius_m); ++y) {
      const auto at = cells_.find(key(x, y));
      if (at != cells_.end()) found.insert(found.end(), at->second.begin(), at->second.end());
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace orchard::pose
