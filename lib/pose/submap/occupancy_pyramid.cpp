// SPDX-License-Identifier: BSD-3-Clause
#include "pose/submap/occupancy_pyramid.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

/// The last part of a beam before its return does not mark cells as free [m]: leaves and bark.
constexpr double kBeforeHit_m = 0.6;

/// Min value that a return gives to a cell near it; smaller values are not stored.
constexpr int kBesideMin = 15;

}  // namespace

OccupancyPyramid::OccupancyPyramid(const Eigen::Vector2d& centre_map, double half_side_m,
                                   double cell_m, double kernel_m)
    : cell_m_(cell_m),
      kernel_m_(kernel_m),
      side_(2 * static_cast<int>(std::ceil(half_side_m / cell_m)) + 1),
      corner_map_(centre_map.array() - 0.5 * side_ * cell_m),
      passed_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0),
      levels_(1, std::vector<std::int8_t>(passed_.size(), 0)) {}

int OccupancyPyramid::column(double x_map_m) const {
  return static_cast<int>(std::floor((x_map_m - corner_map_.x()) / cell_m_));
}

int OccupancyPyramid::row(double y_map_m) const {
  return static_cast<int>(std::floor((y_map_m - corner_map_.y()) / cell_m_));
}

void OccupancyPyramid::add(const Eigen::Vector2d& laser_map, const Eigen::Vector2d& hit_map) {
  const auto index = [this](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
           static_cast<std::size_t>(x);
  };
  const double length_m = (hit_map - laser_map).norm();
  const int steps = static_cast<int>((length_m - kBeforeHit_m) / cell_m_);
  for (int step = 0; step < steps; ++step) {
    const Eigen::Vector2d p = laser_map + (step * cell_m_ / length_m) * (hit_map - laser_map);
    const int x = column(p.x()), y = row(p.y());
    if (x >= 0 && y >= 0 && x < side_ && y < side_) passed_[index(x, y)] = 1;
  }
  const int reach = static_cast<int>(std::ceil(2.0 * kernel_m_ / cell_m_));
  const int x0 = column(hit_map.x()), y0 = row(hit_map.y());
  for (int y = std::max(0, y0 - reach); y <= std::min(side_ - 1, y0 + reach); ++y) {
    for (int x = std::max(0, x0 - reach); x <= std::min(side_ - 1, x0 + reach); ++x) {
      const double d2 = ((x - x0) * (x - x0) + (y - y0) * (y - y0)) * cell_m_ * cell_m_;
      const int value =
          static_cast<int>(std::lround(kHit * std::exp(-0.5 * d2 / (kernel_m_ * kernel_m_))));
      std::int8_t& cell = levels_[0][index(x, y)];
      if (value >= kBesideMin && value > cell) cell = static_cast<std::int8_t>(value);
    }
  }
}

void OccupancyPyramid::finish() {
  for (std::size_t i = 0; i < passed_.size(); ++i) {
    if (levels_[0][i] == 0 && passed_[i] != 0) levels_[0][i] = kThrough;
  }
  const auto n = static_cast<std::size_t>(side_);
  for (int level = 1; level < kLevels; ++level) {
    const std::vector<std::int8_t>& fine = levels_.back();
    const std::size_t step = std::size_t{1} << (level - 1);
    std::vector<std::int8_t> wide(fine.size());
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        // Cells outside the raster are unknown: 0.
        const std::int8_t right = x + step < n ? fine[y * n + x + step] : std::int8_t{0};
        wide[y * n + x] = std::max(fine[y * n + x], right);
      }
    }
    std::vector<std::int8_t> coarse(fine.size());
    for (std::size_t y = 0; y < n; ++y) {
      for (std::size_t x = 0; x < n; ++x) {
        const std::int8_t below = y + step < n ? wide[(y + step) * n + x] : std::int8_t{0};
        coarse[y * n + x] = std::max(wide[y * n + x], below);
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

}  // namespace orchard::pose
