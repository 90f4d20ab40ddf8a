// SPDX-License-Identifier: BSD-3-Clause
#include "pose/scan_matching/likelihood_field.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::pose {
namespace {

constexpr int kCellsPerKernel = 2;
constexpr int kReachCells = 2 * kCellsPerKernel;

}  // namespace

LikelihoodField::LikelihoodField(const PointMap& map, const Eigen::Vector2d& centre_map,
                                 double half_side_m, double kernel_m)
    : cell_m_(kernel_m / kCellsPerKernel),
      side_(2 * static_cast<int>(std::ceil(half_side_m / cell_m_)) + 1),
      corner_map_(centre_map.array() - 0.5 * side_ * cell_m_),
      fits_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0) {
  std::uint8_t stamp[2 * kReachCells + 1][2 * kReachCells + 1];
  for (int dy = -kReachCells; dy <= kReachCells; ++dy) {
    for (int dx = -kReachCells; dx <= kReachCells; ++dx) {
      const double u2 =
          static_cast<double>(dx * dx + dy * dy) / (kCellsPerKernel * kCellsPerKernel);
      stamp[dy + kReachCells][dx + kReachCells] =
          static_cast<std::uint8_t>(std::lround(255.0 * std::exp(-0.5 * u2)));
    }
  }
  map.visit(centre_map, half_side_m, [&](const Eigen::Vector2d& p_map) {
    const Eigen::Vector2d in_cells = (p_map - corner_map_) / cell_m_;
    const int ix = static_cast<int>(std::floor(in_cells.x()));
    const int iy = static_cast<int>(std::floor(in_cells.y()));
    if (ix < 0 || iy < 0 || ix >= side_ || iy >= side_) return;
    std::uint8_t* cell = &fits_[static_cast<std::size_t>(iy) * side_ + ix];
    if (*cell == 255) return;
    for (int dy = std::max(-kReachCells, -iy); dy <= std::min(kReachCells, side_ - 1 - iy); ++dy) {
      for (int dx = std::max(-kReachCells, -ix); dx <= std::min(kReachCells, side_ - 1 - ix);
           ++dx) {
        std::uint8_t& fit = cell[dy * side_ + dx];
        fit = std::max(fit, stamp[dy + kReachCells][dx + kReachCells]);
      }
    }
  });
}

double LikelihoodField::score(const std::vector<Eigen::Vector2d>& arms_map,
                              const Eigen::Vector2d& base_map) const {
  const Eigen::Vector2d shift = (base_map - corner_map_) / cell_m_;
  std::int64_t sum = 0;
  for (const Eigen::Vector2d& arm : arms_map) {
    const double x = shift.x() + arm.x() / cell_m_;
    const double y = shift.y() + arm.y() / cell_m_;
    if (!(x >= 0.0 && y >= 0.0 && x < side_ && y < side_)) continue;
    sum += fits_[static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) +
                 static_cast<std::size_t>(x)];
  }
  return arms_map.empty()
             ? 0.0
             : static_cast<double>(sum) / (255.0 * static_cast<double>(arms_map.size()));
}

}  // namespace orchard::pose
