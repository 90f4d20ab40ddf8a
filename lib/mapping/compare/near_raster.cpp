// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/compare/near_raster.hpp"

#include <algorithm>
#include <cmath>

namespace orchard::mapping {

using Eigen::Vector2d;

NearRaster::NearRaster(const std::vector<Vector2d>& points, double radius_m) {
  if (points.empty()) return;
  corner_ = points.front();
  Vector2d far = points.front();
  for (const Vector2d& p : points) {
    corner_ = corner_.cwiseMin(p);
    far = far.cwiseMax(p);
  }
  const double margin_m = 1.5 * radius_m;  // more than the radius, so that no rounding matters
  corner_.array() -= margin_m;
  const Vector2d way_m = far - corner_ + Vector2d::Constant(margin_m);
  const double num_cells_max = 512.0 * static_cast<double>(points.size()) + 4096.0;
  cells_per_m_ = 2.0 / radius_m;
  const auto num_along = [this](double m) { return std::floor(m * cells_per_m_) + 1.0; };
  while (num_along(way_m.x()) * num_along(way_m.y()) > num_cells_max) cells_per_m_ *= 0.5;
  num_columns_ = num_along(way_m.x());
  num_lines_ = num_along(way_m.y());
  const auto num_columns = static_cast<std::size_t>(num_columns_);
  is_near_.assign((num_columns * static_cast<std::size_t>(num_lines_) + 63) / 64, 0);

  const double cell_m = 1.0 / cells_per_m_, reach_m = radius_m * (1.0 + 1e-9);
  for (const Vector2d& p : points) {
    const Vector2d at = p - corner_;
    const auto first = [&](double m) {
      return static_cast<std::size_t>(std::max(0.0, std::floor((m - reach_m) * cells_per_m_)));
    };
    const auto last = [&](double m, double num) {
      return static_cast<std::size_t>(
          std::min(num - 1.0, std::floor((m + reach_m) * cells_per_m_)));
    };
    const auto beyond_m = [&](double m, std::size_t cell) {
      const double low_m = static_cast<double>(cell) * cell_m;
      return std::max({0.0, low_m - m, m - low_m - cell_m});
    };
    for (std::size_t y = first(at.y()); y <= last(at.y(), num_lines_); ++y) {
      for (std::size_t x = first(at.x()); x <= last(at.x(), num_columns_); ++x) {
        if (std::hypot(beyond_m(at.x(), x), beyond_m(at.y(), y)) > reach_m) continue;
        const std::size_t k = y * num_columns + x;
        is_near_[k / 64] |= std::uint64_t{1} << (k % 64);
      }
    }
  }
}

}  // namespace orchard::mapping
