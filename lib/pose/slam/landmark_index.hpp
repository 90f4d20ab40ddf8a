// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace orchard::pose {

/// Finds the landmarks near a position: a hash grid of square cells. Never iterated.
class SlamLandmarkIndex {
 public:
  void insert(int landmark, const Eigen::Vector2d& p_map);
  void clear() { cells_.clear(); }

  /// All within `radius_m` and some beyond, ascending.
  std::vector<int> near(const Eigen::Vector2d& p_map, double radius_m) const;

 private:
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

}  // namespace orchard::pose
