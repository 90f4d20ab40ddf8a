// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace orchard::mapping {

/// A raster of the plane that rules out, without a search, most positions far from all of its
/// points. Memory: at most 64 bytes per point.
class NearRaster {
 public:
  /// `radius_m` > 0.
  NearRaster(const std::vector<Eigen::Vector2d>& points, double radius_m);

  /// False only if no point is within the radius of `p`.
  bool may_be_near(const Eigen::Vector2d& p) const {
    const double x = (p.x() - corner_.x()) * cells_per_m_, y = (p.y() - corner_.y()) * cells_per_m_;
    if (!(x >= 0.0 && y >= 0.0 && x < num_columns_ && y < num_lines_)) return false;
    const std::size_t k = static_cast<std::size_t>(y) * static_cast<std::size_t>(num_columns_) +
                          static_cast<std::size_t>(x);
    return (is_near_[k / 64] >> (k % 64)) & 1u;
  }

 private:
  Eigen::Vector2d corner_{0.0, 0.0};
  double cells_per_m_ = 1.0;
  double num_columns_ = 0.0, num_lines_ = 0.0;
  std::vector<std::uint64_t> is_near_;  ///< a bit per cell, line by line
};

}  // namespace orchard::mapping
